#include "adaptive_grid_stereo/simulation/flight_bag_writer.h"

#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <rosbag/view.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/Imu.h>
#include <stereo_msgs/DisparityImage.h>
#include <tf2_msgs/TFMessage.h>

#include "adaptive_grid_stereo/simulation/flight_plan.h"
#include "adaptive_grid_stereo/simulation/landscape.h"

namespace adaptive_grid_stereo {
namespace simulation {
namespace {

// A bag of one second in a temporary file.
class FlightBagTest : public ::testing::Test {
 protected:
  void SetUp() override {
    renderer_.rig.width = 64;
    renderer_.rig.height = 36;
    renderer_.rig.focal = 50.0;
    renderer_.samples = 2;
    config_.rig = renderer_.rig;
  }
  void TearDown() override {
    for (const std::string& path : paths_) std::remove(path.c_str());
  }

  std::string write(std::uint64_t seed) {
    const std::string path = ::testing::TempDir() + "flight_" + std::to_string(getpid()) + "_" +
                             std::to_string(paths_.size()) + ".bag";
    paths_.push_back(path);
    renderer_.seed = seed;
    SensorConfig sensors;
    sensors.seed = seed;
    const Scene scene(makeLandscape(flight_, LandscapeConfig()));
    FlightBagWriter writer(path, config_);
    writer.write(flight_, Sensors(sensors), Renderer(scene, renderer_),
                 [this](long done) { progress_ = done; });
    return path;
  }

  static std::string bytesOf(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream bytes;
    bytes << file.rdbuf();
    return bytes.str();
  }

  const Trajectory flight_ = makeFlight(manoeuvresFromString("yaw_left"), 1.0);
  FlightBagConfig config_;
  RendererConfig renderer_;
  long progress_ = 0;
  std::vector<std::string> paths_;
};

TEST_F(FlightBagTest, EveryTopicComesAtItsRate) {
  rosbag::Bag bag(write(1));
  std::map<std::string, int> counts;
  for (const rosbag::MessageInstance& message : rosbag::View(bag)) ++counts[message.getTopic()];
  const std::map<std::string, int> expected{{"/stereo/left/image_rect", 10},
                                            {"/stereo/left/camera_info", 10},
                                            {"/stereo/right/image_rect", 10},
                                            {"/stereo/right/camera_info", 10},
                                            {"/ground_truth/disparity", 10},
                                            {"/ground_truth/occlusion", 10},
                                            {"/ground_truth/odom", 51},
                                            {"/imu", 201},
                                            {"/odom", 51},
                                            {"/tf", 51},
                                            {"/mag", 51},
                                            {"/gps/fix", 6},
                                            {"/gps/vel", 6},
                                            {"/tf_static", 1}};
  EXPECT_EQ(counts, expected);
  EXPECT_EQ(progress_, 10);
}

TEST_F(FlightBagTest, PairsAndTruthShareTheirStampsAndMotionIsThereBeforeThem) {
  rosbag::Bag bag(write(1));
  std::map<std::string, std::set<ros::Time>> stamps;
  ros::Time newest_imu;
  for (const rosbag::MessageInstance& message : rosbag::View(bag)) {
    if (const auto image = message.instantiate<sensor_msgs::Image>()) {
      stamps[message.getTopic()].insert(image->header.stamp);
      EXPECT_EQ(newest_imu, image->header.stamp);
    } else if (const auto info = message.instantiate<sensor_msgs::CameraInfo>()) {
      stamps[message.getTopic()].insert(info->header.stamp);
    } else if (const auto truth = message.instantiate<stereo_msgs::DisparityImage>()) {
      stamps[message.getTopic()].insert(truth->header.stamp);
      EXPECT_EQ(truth->header.stamp, truth->image.header.stamp);
    } else if (const auto imu = message.instantiate<sensor_msgs::Imu>()) {
      newest_imu = imu->header.stamp;
    }
  }
  ASSERT_EQ(stamps.size(), 6u);
  for (const auto& [topic, of_topic] : stamps) {
    EXPECT_EQ(of_topic, stamps["/stereo/left/image_rect"]) << topic;
  }
}

TEST_F(FlightBagTest, TruthAndCameraInfoDescribeTheSameRig) {
  rosbag::Bag bag(write(1));
  for (const rosbag::MessageInstance& message : rosbag::View(bag)) {
    if (const auto truth = message.instantiate<stereo_msgs::DisparityImage>()) {
      EXPECT_EQ(truth->image.encoding, "32FC1");
      EXPECT_EQ(truth->image.step, 4u * 64u);
      EXPECT_FLOAT_EQ(truth->f, 50.0f);
      EXPECT_FLOAT_EQ(truth->T, 0.8f);
      EXPECT_GT(truth->max_disparity, truth->min_disparity);
    } else if (const auto info = message.instantiate<sensor_msgs::CameraInfo>()) {
      const bool right = message.getTopic() == "/stereo/right/camera_info";
      EXPECT_DOUBLE_EQ(info->P[3], right ? -50.0 * 0.8 : 0.0);
      EXPECT_EQ(info->header.frame_id, right ? "stereo_right_optical" : "stereo_left_optical");
    }
  }
}

TEST_F(FlightBagTest, StaticTransformsAreLatchedAndCarryTheBaseline) {
  rosbag::Bag bag(write(1));
  rosbag::View view(bag, rosbag::TopicQuery("/tf_static"));
  ASSERT_EQ(view.size(), 1u);
  EXPECT_EQ((*view.getConnections().front()->header)["latching"], "1");
  const auto message = view.begin()->instantiate<tf2_msgs::TFMessage>();
  ASSERT_EQ(message->transforms.size(), 2u);
  const auto& left = message->transforms[0];
  const auto& right = message->transforms[1];
  EXPECT_EQ(left.header.frame_id, "base_link");
  EXPECT_NEAR(left.transform.translation.y - right.transform.translation.y, 0.8, 1e-12);
  // The optical z axis looks along the body's x axis, its x axis to the body's right.
  const auto& q = left.transform.rotation;
  const Eigen::Quaterniond rotation(q.w, q.x, q.y, q.z);
  EXPECT_LT((rotation * Eigen::Vector3d::UnitZ() - Eigen::Vector3d::UnitX()).norm(), 1e-12);
  EXPECT_LT((rotation * Eigen::Vector3d::UnitX() + Eigen::Vector3d::UnitY()).norm(), 1e-12);
}

TEST_F(FlightBagTest, OdometryGivesTheTwistInTheBodyFrame) {
  rosbag::Bag bag(write(1));
  for (const rosbag::MessageInstance& message :
       rosbag::View(bag, rosbag::TopicQuery("/ground_truth/odom"))) {
    const auto odometry = message.instantiate<nav_msgs::Odometry>();
    EXPECT_EQ(odometry->child_frame_id, "base_link");
    EXPECT_NEAR(odometry->twist.twist.linear.x, 9.0, 1e-6);
    EXPECT_NEAR(odometry->twist.twist.linear.y, 0.0, 1e-6);
  }
}

TEST_F(FlightBagTest, SameSeedSameBytes) {
  const std::string first = bytesOf(write(1));
  EXPECT_TRUE(first == bytesOf(write(1)));
  EXPECT_FALSE(first == bytesOf(write(2)));
}

TEST_F(FlightBagTest, CountsFramesBeforeTheEnd) {
  EXPECT_EQ(FlightBagWriter::frameCount(30.0, 10.0), 300);
  EXPECT_EQ(FlightBagWriter::frameCount(0.1, 10.0), 1);
  EXPECT_EQ(FlightBagWriter::frameCount(0.15, 10.0), 2);
}

}  // namespace
}  // namespace simulation
}  // namespace adaptive_grid_stereo
