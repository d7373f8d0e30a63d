// Faults while the node runs: each is survived, and the first good frame after it is served.

#include <atomic>

#include <gtest/gtest.h>
#include <tf2_msgs/TFMessage.h>

#include "adaptive_grid_stereo/GridState.h"
#include "support/node_probe.h"

namespace adaptive_grid_stereo {
namespace {

using stereo_msgs::DisparityImage;

class Faults : public testing::Test {
 protected:
  Faults() : spinner_(4) { spinner_.start(); }

  void SetUp() override {
    ASSERT_TRUE(aircraft_.waitSubscribed());
    ASSERT_TRUE(disparity_.waitConnected() && grid_state_.waitConnected());
    // Clear of what the tests before have left behind.
    stamps() = ros::Time(stamps().toSec() + 100.0);
  }

  static ros::Time& stamps() {
    static ros::Time stamp(1000.0);
    return stamp;
  }
  static ros::Time nextStamp() { return stamps() += ros::Duration(0.1); }

  void expectServed(const ros::Time& stamp, const SyntheticRig& rig = SyntheticRig()) {
    aircraft_.publish(makePair(rig, 6, stamp));
    const auto message = disparity_.waitForStamp(stamp);
    ASSERT_TRUE(message) << "the good pair at " << stamp << " was not served";
    EXPECT_GT(shareAt(*message, 6, 6), 0.9);
    EXPECT_TRUE(grid_state_.waitForStamp(stamp));
  }
  void expectServed() { expectServed(nextStamp()); }

  /// Where the synchronisation starts over in the middle of a pair, one of the next pairs.
  void expectServedSoon() {
    for (int i = 0; i < 10; ++i) {
      const ros::Time stamp = nextStamp();
      aircraft_.publish(makePair(SyntheticRig(), 6, stamp));
      if (disparity_.waitForStamp(stamp, 0.5)) return;
    }
    ADD_FAILURE() << "none of the good pairs up to " << stamps() << " was served";
  }

  ros::NodeHandle handle_;
  FakeAircraft aircraft_{handle_, "/stereo"};
  Listener<DisparityImage> disparity_{handle_, "/stereo/disparity"};
  Listener<GridState> grid_state_{handle_, "/stereo/grid_state"};
  ros::AsyncSpinner spinner_;
};

TEST_F(Faults, CameraGoesAwayAndComesBack) {
  expectServed();
  aircraft_.left.shutdown();
  aircraft_.right.shutdown();
  aircraft_.left_info.shutdown();
  aircraft_.right_info.shutdown();
  FakeAircraft restarted(handle_, "/stereo");
  ASSERT_TRUE(restarted.waitSubscribed());
  aircraft_ = restarted;
  expectServed();
}

TEST_F(Faults, OneSideOnly) {
  expectServed();
  for (int i = 0; i < 20; ++i) {
    const StereoPair pair = makePair(SyntheticRig(), 6, nextStamp());
    aircraft_.left.publish(pair.left);
    aircraft_.left_info.publish(pair.left_info);
  }
  expectServed();
}

TEST_F(Faults, DuplicatedAndReorderedFrames) {
  std::vector<ros::Time> order;
  for (int i = 0; i < 5; ++i) order.push_back(nextStamp());
  expectServed(order[0]);
  expectServed(order[2]);
  const std::size_t before = disparity_.count();
  aircraft_.publish(makePair(SyntheticRig(), 6, order[2]));  // again
  aircraft_.publish(makePair(SyntheticRig(), 6, order[1]));  // late
  expectServed(order[4]);
  EXPECT_EQ(disparity_.count(), before + 1)
      << "neither the duplicate nor the late pair is published";
}

TEST_F(Faults, StampsJumpBack) {
  for (int i = 0; i < 5; ++i) expectServed();
  // A recording starts over.
  stamps() = ros::Time(stamps().toSec() - 50.0);
  for (int i = 0; i < 5; ++i) expectServed();
  // And back by less than what counts as a jump at once.
  stamps() = ros::Time(stamps().toSec() - 0.45);
  disparity_.clear();
  grid_state_.clear();
  for (int i = 0; i < 10; ++i) aircraft_.publish(makePair(SyntheticRig(), 6, nextStamp()));
  expectServed();
}

TEST_F(Faults, StampsJumpForward) {
  expectServed();
  stamps() = ros::Time(stamps().toSec() + 3600.0);
  expectServed();
}

TEST_F(Faults, OneStampFarInTheFuture) {
  expectServed();
  const StereoPair pair = makePair(SyntheticRig(), 6, ros::Time(stamps().toSec() + 1e6));
  aircraft_.left.publish(pair.left);
  // The first pair after it finds the synchronisation restarted in its middle, the second is whole.
  aircraft_.publish(makePair(SyntheticRig(), 6, nextStamp()));
  expectServed();
}

TEST_F(Faults, StampsFartherApartThanRosDurationsReach) {
  // 4294967295 s, e.g. of a driver that fills a field with ones.
  const ros::Time damaged = ros::TIME_MAX;
  const StereoPair pair = makePair(SyntheticRig(), 6, damaged);
  expectServed();
  aircraft_.left.publish(pair.left);
  expectServedSoon();
  aircraft_.right_info.publish(pair.right_info);
  expectServedSoon();
  aircraft_.publish(pair);
  expectServedSoon();
  aircraft_.publishOdometry(damaged, 10.0, 0.0);
  aircraft_.publishImu(damaged, 0.0);
  expectServed();
}

TEST_F(Faults, TransformsWithStampsAtTheEndOfTime) {
  ros::Publisher tf = handle_.advertise<tf2_msgs::TFMessage>("/tf", 10);
  ASSERT_TRUE(waitUntil([&] { return tf.getNumSubscribers() > 0; }));
  tf2_msgs::TFMessage message;
  message.transforms.resize(1);
  message.transforms[0].header.frame_id = "base_link";
  message.transforms[0].child_frame_id =
      "turret";  // not the camera, which has no TF in these tests
  message.transforms[0].transform.rotation.w = 1.0;
  for (const ros::Time& stamp : {ros::TIME_MAX, ros::TIME_MAX, nextStamp(), ros::TIME_MAX}) {
    message.transforms[0].header.stamp = stamp;
    tf.publish(message);
  }
  expectServed();
}

TEST_F(Faults, StampsThatAreNeverSet) {
  expectServed();
  const std::size_t before = disparity_.count();
  for (std::size_t i = 0; i < 3; ++i) {
    aircraft_.publish(makePair(SyntheticRig(), 6, ros::Time()));
    EXPECT_TRUE(waitUntil([&] { return disparity_.count() > before + i; })) << i;
  }
  expectServed();
}

TEST_F(Faults, CameraInfoChangesItsSizeAndBaseline) {
  expectServed();
  SyntheticRig other;
  other.width = 96;
  other.height = 64;
  other.baseline = 0.5;
  other.focal_length = 80.0;
  const ros::Time stamp = nextStamp();
  expectServed(stamp, other);
  const auto message = disparity_.waitForStamp(stamp);
  ASSERT_TRUE(message);
  EXPECT_EQ(message->image.width, 96U);
  EXPECT_FLOAT_EQ(message->T, 0.5F);
  EXPECT_FLOAT_EQ(message->f, 80.0F);
  const ros::Time back = nextStamp();
  expectServed(back);
  EXPECT_FLOAT_EQ(disparity_.waitForStamp(back)->T, 0.2F);
}

TEST_F(Faults, SensorsAreLostInTurnAndComeBack) {
  ASSERT_TRUE(waitUntil([&] {
    return aircraft_.odom.getNumSubscribers() > 0 && aircraft_.imu.getNumSubscribers() > 0;
  }));
  // Images and motion come by different connections, so that a pair may overtake its motion: tried
  // until the answer is as expected. The node waits for the motion of sources that have been there
  // within motion_timeout, so the steps are shorter than that.
  const auto stateWith = [&](bool with_odom, bool with_imu) {
    GridStateConstPtr state;
    for (int attempt = 0; attempt < 20; ++attempt) {
      const ros::Time stamp = stamps() += ros::Duration(0.3);
      for (int i = -19; i <= 10; ++i) {
        const ros::Time at = stamp + ros::Duration(0.01 * i);
        if (with_odom) aircraft_.publishOdometry(at, 15.0, 0.0);
        if (with_imu) aircraft_.publishImu(at, 0.0);
      }
      aircraft_.publish(makePair(SyntheticRig(), 6, stamp));
      state = grid_state_.waitForStamp(stamp);
      if (!state) break;
      const bool rates_as_expected = !with_odom || (state->rate_source == "imu") == with_imu;
      if (static_cast<bool>(state->motion_valid) == with_odom && rates_as_expected) break;
    }
    return state;
  };
  const auto both = stateWith(true, true);
  ASSERT_TRUE(both);
  EXPECT_TRUE(both->motion_valid) << both->motion_status;
  EXPECT_EQ(both->rate_source, "imu");

  const auto no_imu = stateWith(true, false);
  ASSERT_TRUE(no_imu);
  EXPECT_TRUE(no_imu->motion_valid) << no_imu->motion_status;
  EXPECT_EQ(no_imu->rate_source, "odom") << "the odometry has rates too";

  const auto no_odom = stateWith(false, true);
  ASSERT_TRUE(no_odom);
  EXPECT_FALSE(no_odom->motion_valid);
  EXPECT_NE(no_odom->motion_status.find("speed"), std::string::npos) << no_odom->motion_status;
  for (const int paths : no_odom->paths) EXPECT_EQ(paths, 8);

  const auto nothing = stateWith(false, false);
  ASSERT_TRUE(nothing);
  EXPECT_FALSE(nothing->motion_valid);

  const auto again = stateWith(true, true);
  ASSERT_TRUE(again);
  EXPECT_TRUE(again->motion_valid) << again->motion_status;
  EXPECT_EQ(again->state, GridState::FORWARD);
}

TEST_F(Faults, ParametersChangeFiftyTimesASecondWhileFramesArrive) {
  std::atomic<bool> done{false};
  std::atomic<int> changes{0};
  std::thread user([&] {
    for (int i = 0; !done; ++i) {
      dynamic_reconfigure::Config config;
      addInt(config, "disparity_range", i % 2 == 0 ? 48 : 32);
      addDouble(config, "sigma1", 0.2 + 0.01 * (i % 10));
      addInt(config, "threads", 1 + i % 2);
      if (reconfigure("/stereo/disparity", config)) ++changes;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  });
  for (int i = 0; i < 60; ++i) {
    expectServed();
    if (HasFatalFailure()) break;
  }
  EXPECT_TRUE(waitUntil([&] { return changes > 10; }));
  done = true;
  user.join();
  expectServed();
}

TEST_F(Faults, SubscribersComeAndGoTwentyTimesASecond) {
  for (int i = 0; i < 40; ++i) {
    Listener<sensor_msgs::Image> overlay(handle_, "/stereo/grid_overlay");
    Listener<sensor_msgs::Image> depth(handle_, "/stereo/depth");
    aircraft_.publish(makePair(SyntheticRig(), 6, nextStamp()));
    std::this_thread::sleep_for(std::chrono::milliseconds(25));
  }
  expectServed();
}

TEST_F(Faults, FramesComeFasterThanTheyCanBeProcessed) {
  // Newest wins: of a burst the last one is always served, and what was replaced is counted.
  expectServed();
  const std::size_t before = disparity_.count();
  constexpr int kBurst = 60;
  ros::Time last;
  for (int i = 0; i < kBurst; ++i) {
    last = nextStamp();
    aircraft_.publish(makePair(SyntheticRig(), 6, last));
  }
  const auto state = grid_state_.waitForStamp(last);
  ASSERT_TRUE(state) << "the newest frame of the burst";
  ros::Time previous;
  for (const auto& message : disparity_.all()) {
    if (message->header.stamp > ros::Time(last.toSec() - 0.1 * kBurst)) {
      EXPECT_GT(message->header.stamp, previous) << "in order";
      previous = message->header.stamp;
    }
  }
  EXPECT_LE(disparity_.count(), before + kBurst);
  expectServed();
}

TEST_F(Faults, TargetPeriodTakesPathsAwayAndGivesThemBack) {
  const auto stepAfter = [&](int frames) {
    int step = -1;
    for (int i = 0; i < frames; ++i) {
      const ros::Time stamp = nextStamp();
      aircraft_.publish(makePair(SyntheticRig(), 6, stamp));
      const auto state = grid_state_.waitForStamp(stamp);
      if (!state) return -1;
      step = state->governor_step;
    }
    return step;
  };
  dynamic_reconfigure::Config config;
  addDouble(config, "target_period", 1e-6);  // out of reach: as if all of the CPU were taken
  ASSERT_TRUE(reconfigure("/stereo/disparity", config));
  EXPECT_EQ(stepAfter(20), 3);
  config.doubles.clear();
  addDouble(config, "target_period", 10.0);  // all the time in the world
  ASSERT_TRUE(reconfigure("/stereo/disparity", config));
  EXPECT_EQ(stepAfter(120), 0);
  config.doubles.clear();
  addDouble(config, "target_period", 0.0);
  ASSERT_TRUE(reconfigure("/stereo/disparity", config));
  EXPECT_EQ(stepAfter(1), 0);
}

}  // namespace
}  // namespace adaptive_grid_stereo

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "faults_test");
  return RUN_ALL_TESTS();
}
