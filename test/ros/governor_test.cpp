#include "adaptive_grid_stereo/ros/governor.h"

#include <gtest/gtest.h>

namespace adaptive_grid_stereo {
namespace {

constexpr double kTarget = 0.1;

/// Feeds the same time `frames` times and returns the step after the last.
int feed(DeadlineGovernor& governor, double time, int frames) {
  for (int i = 0; i < frames; ++i) governor.update(time, kTarget);
  return governor.step();
}

TEST(Governor, StepsDownOncePerWindowWhileTooSlow) {
  DeadlineGovernor governor;
  EXPECT_EQ(feed(governor, 0.2, DeadlineGovernor::kWindow - 1), 0);
  EXPECT_EQ(feed(governor, 0.2, 1), 1);
  EXPECT_EQ(feed(governor, 0.2, DeadlineGovernor::kWindow - 1), 1) << "a step needs time to show";
  EXPECT_EQ(feed(governor, 0.2, 1), 2);
  EXPECT_EQ(feed(governor, 0.2, DeadlineGovernor::kWindow), 3);
  EXPECT_EQ(feed(governor, 0.2, 100), 3) << "there is no further step";
}

TEST(Governor, LooksAtTheMedianNotAtSingleFrames) {
  DeadlineGovernor governor;
  for (int i = 0; i < 50; ++i) {
    governor.update(i % 3 == 0 ? 0.5 : 0.08, kTarget);
    EXPECT_EQ(governor.step(), 0) << "at frame " << i;
  }
}

TEST(Governor, StaysBetweenRoomAndTarget) {
  DeadlineGovernor governor;
  feed(governor, 0.2, DeadlineGovernor::kWindow);
  ASSERT_EQ(governor.step(), 1);
  EXPECT_EQ(feed(governor, 0.08, 1000), 1) << "within the target, but no room to give paths back";
}

TEST(Governor, GivesPathsBackWhereThereIsRoom) {
  DeadlineGovernor governor;
  feed(governor, 0.2, 3 * DeadlineGovernor::kWindow);
  ASSERT_EQ(governor.step(), 3);
  feed(governor, 0.01, 3 * (DeadlineGovernor::kLongestPatience + DeadlineGovernor::kWindow));
  EXPECT_EQ(governor.step(), 0);
}

TEST(Governor, WaitsLongerAfterEachStepThatHadToBeTakenBack) {
  // A load that fits only at step 1: the ladder must not swing all the time.
  DeadlineGovernor governor;
  int changes = 0;
  int last = 0;
  for (int i = 0; i < 2000; ++i) {
    const int step = governor.update(governor.step() == 0 ? 0.15 : 0.05, kTarget);
    if (step != last) ++changes;
    last = step;
  }
  EXPECT_GE(changes, 3) << "it tries again";
  EXPECT_LE(changes, 20) << "but ever more seldom";
}

TEST(Governor, IsOffWithoutTarget) {
  DeadlineGovernor governor;
  feed(governor, 0.2, 3 * DeadlineGovernor::kWindow);
  ASSERT_EQ(governor.step(), 3);
  EXPECT_EQ(governor.update(0.2, 0.0), 0) << "switching it off gives all paths back";
}

TEST(Governor, LimitsTheLadderStepByStep) {
  const struct {
    int focus, near, far, unknown;
  } expected[] = {{16, 8, 4, 8}, {8, 8, 4, 8}, {8, 4, 4, 4}, {4, 4, 4, 4}};
  for (int step = 0; step <= DeadlineGovernor::kLastStep; ++step) {
    const GuidanceConfig config = DeadlineGovernor::limitPaths(GuidanceConfig(), step);
    EXPECT_EQ(config.paths_focus, expected[step].focus) << step;
    EXPECT_EQ(config.paths_near, expected[step].near) << step;
    EXPECT_EQ(config.paths_far, expected[step].far) << step;
    EXPECT_EQ(config.paths_unknown, expected[step].unknown) << step;
    GuidanceConfig checked = config;
    EXPECT_TRUE(checked.validate().empty()) << step;
  }
}

TEST(Governor, NeverGivesMoreThanConfigured) {
  GuidanceConfig config;
  config.paths_focus = config.paths_near = config.paths_far = 4;
  for (int step = 0; step <= DeadlineGovernor::kLastStep; ++step) {
    EXPECT_EQ(DeadlineGovernor::limitPaths(config, step).paths_focus, 4);
  }
}

}  // namespace
}  // namespace adaptive_grid_stereo
