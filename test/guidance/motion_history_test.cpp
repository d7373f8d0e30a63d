#include "adaptive_grid_stereo/guidance/motion_history.h"

#include <cmath>

#include <gtest/gtest.h>

#include "adaptive_grid_stereo/guidance/flight_state.h"

namespace adaptive_grid_stereo {
namespace {

Motion motionAt(double stamp) {
  Motion motion;
  motion.valid = true;
  motion.forward_speed = 10.0;
  motion.yaw_rate = 0.35 * std::sin(3.0 * stamp) + 0.1 * std::sin(17.0 * stamp);
  motion.pitch_rate = 0.3 * std::sin(2.0 * stamp) + 0.1 * std::cos(23.0 * stamp);
  return motion;
}

TEST(MotionHistoryTest, HoldsTheInstantsSinceTheLastQuestion) {
  MotionHistory history;
  Motion motion = history.ask(100.05, motionAt);
  EXPECT_TRUE(motion.has_history);
  EXPECT_EQ(motion.history.size(), 100u) << "two seconds at first";
  motion = history.ask(100.11, motionAt);
  ASSERT_EQ(motion.history.size(), 3u);
  EXPECT_NEAR(motion.history[0].stamp, 100.06, 1e-9);
  EXPECT_NEAR(motion.history[2].stamp, 100.10, 1e-9);
  EXPECT_EQ(motion.history[1].yaw_rate, motionAt(motion.history[1].stamp).yaw_rate);
  EXPECT_TRUE(history.ask(100.115, motionAt).history.empty());
  EXPECT_EQ(history.ask(500.0, motionAt).history.size(), 100u) << "no longer than two seconds";
  EXPECT_GE(history.ask(20.0, motionAt).history.size(), 99u) << "after a step back";
}

TEST(MotionHistoryTest, StatesDoNotDependOnWhichFramesAreProcessed) {
  const GuidanceConfig config;
  const auto statesOf = [&](int every) {
    MotionHistory history;
    FlightStateMachine machine;
    std::vector<std::string> states;
    for (int i = 0; i <= 3000; i += every) {
      const double stamp = 50.0 + i / 30.0;
      const FlightState state = machine.update(history.ask(stamp, motionAt), stamp, config);
      if (i % 30 == 0) states.push_back(toString(state));
    }
    return states;
  };
  const auto all = statesOf(1);
  EXPECT_EQ(all, statesOf(2));
  EXPECT_EQ(all, statesOf(15));
  int yaw = 0;
  for (const std::string& state : all) yaw += state.find("YAW") != std::string::npos;
  EXPECT_GT(yaw, 10);
  EXPECT_LT(yaw, 90);
}

}  // namespace
}  // namespace adaptive_grid_stereo
