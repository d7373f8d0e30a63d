// In place of stereo_image_proc/disparity: its point cloud nodelet works on our output, and no
// parameter of an existing launch file is in the way.

#include <cmath>

#include <gtest/gtest.h>
#include <sensor_msgs/PointCloud2.h>
#include <sensor_msgs/point_cloud2_iterator.h>

#include "support/node_probe.h"

namespace adaptive_grid_stereo {
namespace {

TEST(DropIn, LetsPointCloud2PlaceTheWall) {
  ros::NodeHandle handle;
  FakeAircraft aircraft(handle, "/stereo");
  Listener<sensor_msgs::PointCloud2> cloud(handle, "/stereo/points2");
  StampSource stamps;
  const SyntheticRig rig;
  // One process holds one connection per topic, so it cannot be seen from here when both nodelets
  // have subscribed: the first cloud tells.
  ASSERT_TRUE(waitUntil([&] {
    aircraft.publish(makePair(rig, 6, stamps.next()));
    return cloud.waitFor([](const auto&) { return true; }, 0.2) != nullptr;
  }));
  for (const int shift : {5, 10, 25}) {
    const ros::Time stamp = stamps.next();
    aircraft.publish(makePair(rig, shift, stamp));
    const auto message = cloud.waitForStamp(stamp);
    ASSERT_TRUE(message);
    const double depth = rig.focal_length * rig.baseline / shift;
    int good = 0;
    int all = 0;
    sensor_msgs::PointCloud2ConstIterator<float> z(*message, "z");
    for (unsigned i = 0; i < message->width * message->height; ++i, ++z) {
      if (static_cast<int>(i % message->width) < shift) continue;
      ++all;
      if (std::abs(*z - depth) < 0.05 * depth) ++good;
    }
    EXPECT_GT(good, 0.9 * all) << "the wall at " << depth << " m";
  }
}

TEST(DropIn, TakesTheParametersOfTheSameMeaning) {
  int range = 0;
  ASSERT_TRUE(ros::param::get("/stereo/disparity/disparity_range", range));
  EXPECT_EQ(range, 64);
  dynamic_reconfigure::Config response;
  ASSERT_TRUE(reconfigure("/stereo/disparity", dynamic_reconfigure::Config(), &response));
  const auto valueOf = [&](const std::string& name) {
    for (const auto& parameter : response.ints) {
      if (parameter.name == name) return static_cast<double>(parameter.value);
    }
    for (const auto& parameter : response.doubles) {
      if (parameter.name == name) return parameter.value;
    }
    return std::nan("");
  };
  EXPECT_EQ(valueOf("disparity_range"), 64);
  EXPECT_EQ(valueOf("uniqueness_ratio"), 5.0);
  EXPECT_EQ(valueOf("speckle_size"), 100);
  EXPECT_EQ(valueOf("speckle_range"), 4);
  EXPECT_EQ(valueOf("disp12MaxDiff"), 1);
}

}  // namespace
}  // namespace adaptive_grid_stereo

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "drop_in_test");
  ros::start();  // until the end, not only while a test holds a node handle
  ros::AsyncSpinner spinner(4);
  spinner.start();
  return RUN_ALL_TESTS();
}
