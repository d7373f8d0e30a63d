// Exact and approximate synchronisation: what is paired, what is not, and what the node says then.

#include <gtest/gtest.h>

#include "support/node_probe.h"

namespace adaptive_grid_stereo {
namespace {

using stereo_msgs::DisparityImage;

class Sync : public testing::Test {
 protected:
  Sync() : spinner_(4) { spinner_.start(); }

  /// A pair whose right camera is late by `delay` [s].
  static StereoPair makeLatePair(const ros::Time& stamp, double delay) {
    const StereoPair pair = makePair(SyntheticRig(), 6, stamp);
    auto right = boost::make_shared<sensor_msgs::Image>(*pair.right);
    auto info = boost::make_shared<sensor_msgs::CameraInfo>(*pair.right_info);
    right->header.stamp += ros::Duration(delay);
    info->header.stamp += ros::Duration(delay);
    return StereoPair{pair.left, right, pair.left_info, info};
  }

  ros::NodeHandle handle_;
  StampSource stamps_;
  ros::AsyncSpinner spinner_;
};

TEST_F(Sync, ExactPairsEqualStampsOnlyAndNamesTheCure) {
  FakeAircraft aircraft(handle_, "/exact");
  Listener<rosgraph_msgs::Log> log(handle_, "/rosout");
  Listener<DisparityImage> disparity(handle_, "/exact/disparity");
  ASSERT_TRUE(aircraft.waitSubscribed());
  ASSERT_TRUE(log.waitConnected(3));  // both nodes and this test
  // Left and right differ by 2 ms for longer than the node's patience.
  bool advised = false;
  for (int i = 0; i < 200 && !advised; ++i) {
    aircraft.publish(makeLatePair(stamps_.next(), 0.002));
    advised = log.waitFor(
                  [](const rosgraph_msgs::Log& line) {
                    return line.level == rosgraph_msgs::Log::WARN &&
                           line.msg.find("set approximate_sync") != std::string::npos &&
                           line.msg.find("/exact/right/image_rect") != std::string::npos;
                  },
                  0.1) != nullptr;
  }
  EXPECT_TRUE(advised);
  EXPECT_EQ(disparity.count(), 0U);
  const ros::Time stamp = stamps_.next();
  aircraft.publish(makePair(SyntheticRig(), 6, stamp));
  EXPECT_TRUE(disparity.waitForStamp(stamp)) << "equal stamps are served at once";
}

TEST_F(Sync, NamesTheInputOnWhichNothingArrives) {
  FakeAircraft aircraft(handle_, "/exact");
  Listener<rosgraph_msgs::Log> log(handle_, "/rosout");
  Listener<DisparityImage> disparity(handle_, "/exact/disparity");
  ASSERT_TRUE(aircraft.waitSubscribed());
  ASSERT_TRUE(log.waitConnected(3));  // both nodes and this test
  bool advised = false;
  for (int i = 0; i < 200 && !advised; ++i) {
    const StereoPair pair = makePair(SyntheticRig(), 6, stamps_.next());
    aircraft.left.publish(pair.left);
    aircraft.right.publish(pair.right);
    aircraft.left_info.publish(pair.left_info);
    advised = log.waitFor(
                  [](const rosgraph_msgs::Log& line) {
                    return line.level == rosgraph_msgs::Log::WARN &&
                           line.msg.find("Nothing arrives on /exact/right/camera_info;") !=
                               std::string::npos;
                  },
                  0.1) != nullptr;
  }
  EXPECT_TRUE(advised);
  const ros::Time stamp = stamps_.next();
  aircraft.publish(makePair(SyntheticRig(), 6, stamp));
  EXPECT_TRUE(disparity.waitForStamp(stamp));
}

TEST_F(Sync, EveryFrameFromBeforeAJumpIsServed) {
  FakeAircraft aircraft(handle_, "/exact");
  Listener<DisparityImage> disparity(handle_, "/exact/disparity");
  ASSERT_TRUE(aircraft.waitSubscribed());
  SyntheticRig large;  // so that they come faster than they are matched
  large.width = 1024;
  large.height = 768;
  std::vector<ros::Time> published;
  const auto publish = [&](const SyntheticRig& rig, int count, double later) {
    for (int i = 0; i < count; ++i) {
      published.push_back(stamps_.next() + ros::Duration(later));
      aircraft.publish(makePair(rig, 6, published.back()));
    }
  };
  publish(large, 60, 0.0);
  ASSERT_TRUE(disparity.waitForStamp(published[20])) << "by now all of them are there";
  stamps_ = StampSource();
  publish(SyntheticRig(), 2, 0.05);  // other stamps
  ASSERT_TRUE(disparity.waitForStamp(published.back()));
  for (const ros::Time& stamp : published) EXPECT_TRUE(disparity.waitForStamp(stamp)) << stamp;
  EXPECT_EQ(disparity.count(), published.size());
}

TEST_F(Sync, ApproximatePairsWhatIsCloseAndUsesTheLeftStamp) {
  FakeAircraft aircraft(handle_, "/approximate");
  Listener<DisparityImage> disparity(handle_, "/approximate/disparity");
  ASSERT_TRUE(aircraft.waitSubscribed());
  // The policy decides on a pair when it has seen the next one.
  std::vector<ros::Time> published;
  for (int i = 0; i < 6; ++i) {
    published.push_back(stamps_.next());
    aircraft.publish(makeLatePair(published.back(), 0.01));
  }
  published.pop_back();
  for (const ros::Time& stamp : published) {
    const auto message = disparity.waitForStamp(stamp);
    ASSERT_TRUE(message) << stamp;
    EXPECT_GT(shareAt(*message, 6, 6), 0.9);
  }
}

TEST_F(Sync, ApproximateLeavesWhatIsTooFarApart) {
  FakeAircraft aircraft(handle_, "/approximate");
  Listener<DisparityImage> disparity(handle_, "/approximate/disparity");
  ASSERT_TRUE(aircraft.waitSubscribed());
  for (int i = 0; i < 10; ++i) stamps_.next();
  std::vector<ros::Time> apart;
  for (int i = 0; i < 6; ++i) {
    apart.push_back(stamps_.next());
    aircraft.publish(makeLatePair(apart.back(), 0.045));
  }
  std::vector<ros::Time> close;
  for (int i = 0; i < 6; ++i) {
    close.push_back(stamps_.next());
    aircraft.publish(makeLatePair(close.back(), 0.001));
  }
  ASSERT_TRUE(disparity.waitForStamp(close[3]));
  for (const auto& message : disparity.all()) {
    EXPECT_EQ(std::count(apart.begin(), apart.end(), message->header.stamp), 0)
        << message->header.stamp;
  }
}

}  // namespace
}  // namespace adaptive_grid_stereo

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "sync_test");
  return RUN_ALL_TESTS();
}
