// Eq. 1: LOCKED v <= lock_speed, FORWARD v > lock_speed, YAW: FORWARD and |yaw rate| / Y_max >
// sigma1, PITCH likewise with sigma2; left only below hysteresis * threshold.
#include "adaptive_grid_stereo/guidance/flight_state.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace adaptive_grid_stereo {
namespace {

Motion moving(double speed, double yaw_rate = 0.0, double pitch_rate = 0.0) {
  Motion motion;
  motion.valid = true;
  motion.forward_speed = speed;
  motion.yaw_rate = yaw_rate;
  motion.pitch_rate = pitch_rate;
  return motion;
}

class FlightStateTest : public ::testing::Test {
 protected:
  FlightStateTest() {
    config_.lock_speed = 0.5;
    config_.max_yaw_rate = 2.0;
    config_.max_pitch_rate = 1.0;
    config_.sigma1 = 0.25;  // 0.5 rad/s
    config_.sigma2 = 0.5;   // 0.5 rad/s
    config_.hysteresis = 0.8;
  }

  std::string at(double stamp, const Motion& motion) {
    return toString(machine_.update(motion, stamp, config_));
  }
  std::string next(const Motion& motion) { return at(stamp_ += 0.1, motion); }
  std::string fresh(const Motion& motion) {
    return toString(FlightStateMachine().update(motion, 1.0, config_));
  }

  GuidanceConfig config_;
  FlightStateMachine machine_;
  double stamp_ = 100.0;
};

TEST_F(FlightStateTest, ThresholdsWithoutMemory) {
  EXPECT_EQ(fresh(moving(0.0)), "LOCKED");
  EXPECT_EQ(fresh(moving(-3.0)), "LOCKED");
  EXPECT_EQ(fresh(moving(0.5)), "LOCKED");
  EXPECT_EQ(fresh(moving(0.51)), "FORWARD");
  EXPECT_EQ(fresh(moving(5.0, 0.5)), "FORWARD");
  EXPECT_EQ(fresh(moving(5.0, 0.51)), "FORWARD YAW left");
  EXPECT_EQ(fresh(moving(5.0, -0.51)), "FORWARD YAW right");
  EXPECT_EQ(fresh(moving(5.0, 0.0, 0.51)), "FORWARD PITCH up");
  EXPECT_EQ(fresh(moving(5.0, 0.0, -0.51)), "FORWARD PITCH down");
  EXPECT_EQ(fresh(moving(5.0, -0.6, 0.6)), "FORWARD YAW right PITCH up");
  EXPECT_EQ(fresh(moving(0.5, 0.6, 0.6)), "LOCKED");
}

TEST_F(FlightStateTest, StandingIsLockedEvenWithLockSpeedZero) {
  config_.lock_speed = 0.0;
  EXPECT_EQ(next(moving(0.001)), "FORWARD");
  EXPECT_EQ(next(moving(0.0)), "LOCKED");
}

TEST_F(FlightStateTest, ForwardIsLeftBelowHysteresisOnly) {
  EXPECT_EQ(next(moving(0.45)), "LOCKED");
  EXPECT_EQ(next(moving(0.51)), "FORWARD");
  EXPECT_EQ(next(moving(0.41)), "FORWARD");
  EXPECT_EQ(next(moving(0.39)), "LOCKED");
  EXPECT_EQ(next(moving(0.41)), "LOCKED");
}

TEST_F(FlightStateTest, ManoeuvresAreLeftBelowHysteresisOnly) {
  EXPECT_EQ(next(moving(5.0, 0.45)), "FORWARD");
  EXPECT_EQ(next(moving(5.0, 0.55)), "FORWARD YAW left");
  EXPECT_EQ(next(moving(5.0, 0.41)), "FORWARD YAW left");
  EXPECT_EQ(next(moving(5.0, 0.39)), "FORWARD");
  EXPECT_EQ(next(moving(5.0, 0.0, -0.55)), "FORWARD PITCH down");
  EXPECT_EQ(next(moving(5.0, 0.0, -0.41)), "FORWARD PITCH down");
  EXPECT_EQ(next(moving(5.0, 0.0, -0.39)), "FORWARD");
}

TEST_F(FlightStateTest, OtherSideNeedsItsWholeThreshold) {
  EXPECT_EQ(next(moving(5.0, 0.6)), "FORWARD YAW left");
  EXPECT_EQ(next(moving(5.0, -0.45)), "FORWARD");
  EXPECT_EQ(next(moving(5.0, 0.6)), "FORWARD YAW left");
  EXPECT_EQ(next(moving(5.0, -0.55)), "FORWARD YAW right");
}

TEST_F(FlightStateTest, HysteresisOneIsEquationOne) {
  config_.hysteresis = 1.0;
  EXPECT_EQ(next(moving(5.0, 0.51)), "FORWARD YAW left");
  EXPECT_EQ(next(moving(5.0, 0.49)), "FORWARD");
}

TEST_F(FlightStateTest, ManoeuvresEndWithForward) {
  EXPECT_EQ(next(moving(5.0, 0.6, 0.6)), "FORWARD YAW left PITCH up");
  EXPECT_EQ(next(moving(0.1, 0.6, 0.6)), "LOCKED");
  EXPECT_EQ(next(moving(5.0, 0.45, 0.45)), "FORWARD") << "no memory of before the stop";
}

TEST_F(FlightStateTest, UnknownMotionForgets) {
  EXPECT_EQ(next(moving(5.0, 0.6)), "FORWARD YAW left");
  EXPECT_EQ(next(Motion()), "UNKNOWN");
  EXPECT_EQ(next(moving(5.0, 0.45)), "FORWARD");
  EXPECT_EQ(next(moving(std::nan(""))), "UNKNOWN");
  EXPECT_EQ(next(moving(5.0, std::numeric_limits<double>::infinity())), "UNKNOWN");
}

TEST_F(FlightStateTest, StepBackInTimeForgets) {
  EXPECT_EQ(at(50.0, moving(5.0, 0.6)), "FORWARD YAW left");
  EXPECT_EQ(at(50.0, moving(5.0, 0.45)), "FORWARD YAW left");
  EXPECT_EQ(at(10.0, moving(5.0, 0.45)), "FORWARD");
}

TEST_F(FlightStateTest, DwellHoldsWhatWasEntered) {
  config_.min_dwell_time = 1.0;
  EXPECT_EQ(at(10.0, moving(5.0)), "FORWARD");
  EXPECT_EQ(at(10.5, moving(5.0, 0.6)), "FORWARD YAW left") << "entering does not wait";
  EXPECT_EQ(at(11.4, moving(5.0, 0.0)), "FORWARD YAW left");
  EXPECT_EQ(at(11.6, moving(5.0, 0.0)), "FORWARD");
  EXPECT_EQ(at(11.7, moving(0.0)), "LOCKED");
  EXPECT_EQ(at(12.0, moving(5.0)), "LOCKED");
  EXPECT_EQ(at(12.8, moving(5.0)), "FORWARD");
  EXPECT_EQ(at(13.0, moving(0.0)), "FORWARD");
}

TEST_F(FlightStateTest, MemoryComesFromTheHistoryAlone) {
  const auto withHistory = [](Motion motion, std::initializer_list<MotionPoint> points) {
    motion.has_history = true;
    motion.history = points;
    return motion;
  };
  // A peak between the frames, then the band of the hysteresis: the state holds.
  EXPECT_EQ(at(10.00, withHistory(moving(5.0), {{10.0, true, 5.0, 0.0, 0.0}})), "FORWARD");
  EXPECT_EQ(at(10.10, withHistory(moving(5.0, 0.45),
                                  {{10.02, true, 5.0, 0.6, 0.0}, {10.04, true, 5.0, 0.45, 0.0}})),
            "FORWARD YAW left");
  // A peak of a frame itself leaves no trace, since another run may not have processed that frame.
  EXPECT_EQ(at(10.11, withHistory(moving(5.0), {{10.11, true, 5.0, 0.0, 0.0}})), "FORWARD");
  EXPECT_EQ(at(10.12, withHistory(moving(5.0, 0.6), {})), "FORWARD YAW left");
  EXPECT_EQ(at(10.13, withHistory(moving(5.0, 0.45), {})), "FORWARD");
}

}  // namespace
}  // namespace adaptive_grid_stereo
