#include "adaptive_grid_stereo/ros/frame_processor.h"

#include <chrono>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "adaptive_grid_stereo/ros/input_check.h"
#include "support/synthetic_pair.h"

namespace adaptive_grid_stereo {
namespace {

ProcessorConfig smallConfig() {
  ProcessorConfig config;
  config.matcher.disparity_range = 32;
  return config;
}

Motion flying(double yaw_rate) {
  Motion motion;
  motion.valid = true;
  motion.forward_speed = 20.0;
  motion.yaw_rate = yaw_rate;
  motion.speed_source = "odom";
  motion.rate_source = "imu";
  return motion;
}

FrameResult processOne(FrameProcessor& processor, int shift, double stamp, const Motion& motion,
                       SideOutputs* side = nullptr, const WantedOutputs& wanted = WantedOutputs()) {
  const StereoPair pair = makePair(SyntheticRig(), shift, ros::Time(stamp));
  const InputVerdict verdict = checkPair(pair, InputLimits());
  EXPECT_TRUE(verdict.ok()) << verdict.error;
  FrameResult frame = processor.process(pair, verdict.geometry, motion);
  if (side != nullptr) *side = processor.makeSideOutputs(frame, wanted);
  frame.left.release();  // the pair's memory
  return frame;
}

TEST(FrameProcessor, TurnsAPairAndAMotionIntoMessages) {
  FrameProcessor processor(smallConfig());
  const FrameResult frame = processOne(processor, 7, 10.0, flying(0.5));
  EXPECT_GT(shareAt(*frame.disparity, 7.0, 7), 0.95);
  EXPECT_EQ(frame.disparity->header.stamp, ros::Time(10.0));
  EXPECT_EQ(frame.grid_state->header.stamp, ros::Time(10.0));
  EXPECT_EQ(frame.grid_state->header.frame_id, "left_optical");
  EXPECT_EQ(frame.grid_state->state, GridState::FORWARD | GridState::YAW);
  EXPECT_EQ(frame.grid_state->paths[0], 16) << "turning left: the left column has the focus";
  EXPECT_EQ(frame.grid_state->paths[2], 4);
  EXPECT_GT(frame.grid_state->processing_time, 0.0);
  EXPECT_GT(frame.times.total, 0.0);
}

TEST(FrameProcessor, LeavesMessagesAloneThatSomebodyHas) {
  FrameProcessor processor(smallConfig());
  std::vector<FrameResult> held;
  std::vector<std::vector<std::uint8_t>> data;
  for (int i = 0; i < 8; ++i) {
    held.push_back(processOne(processor, 4 + i, 10.0 + i, Motion()));
    data.push_back(held.back().disparity->image.data);
    if (i % 3 == 0) {  // some are given back, and may be used again
      held.pop_back();
      data.pop_back();
    }
  }
  for (std::size_t i = 0; i < held.size(); ++i) {
    EXPECT_EQ(data[i], held[i].disparity->image.data) << i;
    EXPECT_EQ(held[i].grid_state->header.stamp, held[i].disparity->header.stamp) << i;
  }
}

TEST(FrameProcessor, MakesSideOutputsOnlyIfWanted) {
  FrameProcessor processor(smallConfig());
  SideOutputs none;
  processOne(processor, 7, 10.0, Motion(), &none);
  EXPECT_FALSE(none.depth || none.overlay || none.disparity_color);
  WantedOutputs wanted;
  wanted.depth = wanted.overlay = wanted.disparity_color = true;
  SideOutputs side;
  processOne(processor, 7, 11.0, Motion(), &side, wanted);
  ASSERT_TRUE(side.depth && side.overlay && side.disparity_color);
  EXPECT_EQ(side.depth->encoding, "32FC1");
  EXPECT_EQ(side.overlay->encoding, "bgr8");
  EXPECT_EQ(side.overlay->data.size(),
            static_cast<std::size_t>(side.overlay->step) * side.overlay->height);
  EXPECT_EQ(side.disparity_color->encoding, "bgr8");
}

TEST(FrameProcessor, TakesPathsAwayWhereItIsThePicturesThatTakeTooLong) {
  ProcessorConfig config = smallConfig();
  config.target_period = 0.2;
  FrameProcessor processor(config);
  WantedOutputs wanted;
  wanted.overlay = true;
  const StereoPair pair = makePair(SyntheticRig(), 7, ros::Time(10.0));
  const StereoGeometry geometry = checkPair(pair, InputLimits()).geometry;
  // As many pictures of each frame as take longer than the target, however fast this machine is.
  for (int i = 0; i < DeadlineGovernor::kWindow; ++i) {
    const FrameResult frame = processor.process(pair, geometry, flying(0.0));
    EXPECT_EQ(frame.grid_state->governor_step, 0) << i;
    const auto start = std::chrono::steady_clock::now();
    while (std::chrono::steady_clock::now() - start < std::chrono::milliseconds(250)) {
      processor.makeSideOutputs(frame, wanted);
    }
  }
  EXPECT_GT(processor.process(pair, geometry, flying(0.0)).grid_state->governor_step, 0);
}

TEST(FrameProcessor, GivesTheSameBitsForTheSameSequence) {
  FrameProcessor first(smallConfig());
  FrameProcessor second(smallConfig());
  for (int i = 0; i < 4; ++i) {
    const Motion motion = flying(i % 2 == 0 ? 0.5 : 0.27);  // in the band of the hysteresis
    const FrameResult a = processOne(first, 3 + i, 10.0 + i, motion);
    const FrameResult b = processOne(second, 3 + i, 10.0 + i, motion);
    EXPECT_EQ(a.disparity->image.data, b.disparity->image.data) << i;
    EXPECT_EQ(a.grid_state->state, b.grid_state->state) << i;
    EXPECT_EQ(a.plan, b.plan) << i;
  }
}

TEST(FrameProcessor, TakesANewConfigWithTheNextFrame) {
  FrameProcessor processor(smallConfig());
  processOne(processor, 7, 10.0, flying(0.5));
  ProcessorConfig config = smallConfig();
  config.matcher.disparity_range = 48;
  config.guidance.sigma1 = 0.9;
  processor.setConfig(config);
  const FrameResult frame = processOne(processor, 7, 20.0, flying(0.5));
  EXPECT_FLOAT_EQ(frame.disparity->max_disparity, 47.0F);
  EXPECT_EQ(frame.grid_state->state, GridState::FORWARD) << "0.5 is below sigma1 = 0.9";
}

TEST(FrameProcessor, RefusesABadConfigAndKeepsTheOldOne) {
  FrameProcessor processor(smallConfig());
  ProcessorConfig bad = smallConfig();
  bad.matcher.disparity_range = 5;
  EXPECT_THROW(processor.setConfig(bad), std::invalid_argument);
  bad = smallConfig();
  bad.target_period = -1.0;
  EXPECT_THROW(processor.setConfig(bad), std::invalid_argument);
  EXPECT_THROW(FrameProcessor{bad}, std::invalid_argument);
  EXPECT_EQ(processor.config().matcher.disparity_range, 32);
  EXPECT_FLOAT_EQ(processOne(processor, 7, 1.0, Motion()).disparity->max_disparity, 31.0F);
}

TEST(FrameProcessor, TakesPathsAwayToKeepTheTarget) {
  ProcessorConfig config = smallConfig();
  config.target_period = 1e-9;  // cannot be kept
  FrameProcessor processor(config);
  int last = 0;
  for (int i = 0; i < 4 * DeadlineGovernor::kWindow; ++i) {
    last = processOne(processor, 7, 10.0 + i, flying(0.0)).grid_state->governor_step;
  }
  EXPECT_EQ(last, DeadlineGovernor::kLastStep);
  const FrameResult slow = processOne(processor, 7, 100.0, flying(0.0));
  for (const int paths : slow.plan.paths) EXPECT_EQ(paths, 4);
  config.target_period = 0.0;
  processor.setConfig(config);
  const FrameResult full = processOne(processor, 7, 101.0, flying(0.0));
  EXPECT_EQ(full.grid_state->governor_step, 0);
  EXPECT_EQ(full.plan.paths[4], 16);
}

TEST(FrameProcessor, TakesImagesThatChangeTheirSize) {
  FrameProcessor processor(smallConfig());
  for (const int width : {128, 65, 33, 200, 128}) {
    SyntheticRig rig;
    rig.width = width;
    const StereoPair pair = makePair(rig, 5, ros::Time(1 + width));
    const InputVerdict verdict = checkPair(pair, InputLimits());
    ASSERT_TRUE(verdict.ok()) << verdict.error;
    const FrameResult frame = processor.process(pair, verdict.geometry, Motion());
    EXPECT_EQ(frame.disparity->image.width, static_cast<unsigned>(width));
    EXPECT_GT(shareAt(*frame.disparity, 5.0, 5), 0.9) << width;
  }
}

}  // namespace
}  // namespace adaptive_grid_stereo
