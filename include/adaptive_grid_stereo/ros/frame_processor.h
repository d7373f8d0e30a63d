#ifndef ADAPTIVE_GRID_STEREO_ROS_FRAME_PROCESSOR_H
#define ADAPTIVE_GRID_STEREO_ROS_FRAME_PROCESSOR_H

#include <vector>

#include <sensor_msgs/Image.h>
#include <stereo_msgs/DisparityImage.h>
#include <opencv2/core.hpp>

#include "adaptive_grid_stereo/GridState.h"
#include "adaptive_grid_stereo/guidance/flight_state.h"
#include "adaptive_grid_stereo/guidance/guidance_config.h"
#include "adaptive_grid_stereo/guidance/motion.h"
#include "adaptive_grid_stereo/matching/stereo_matcher.h"
#include "adaptive_grid_stereo/path_plan.h"
#include "adaptive_grid_stereo/ros/governor.h"
#include "adaptive_grid_stereo/ros/stereo_pair.h"

namespace adaptive_grid_stereo {

/// Everything that decides what a pair is turned into.
struct ProcessorConfig {
  MatcherConfig matcher;
  GuidanceConfig guidance;
  /// Longest processing time per frame [s], 0..10, kept by taking paths away; 0: no governor. With
  /// it the plan depends on the clock, so offline processing leaves it at 0.
  double target_period = 0.0;
  /// Significant bits of 16-bit images: 0 (seen from the data), or 8..16.
  int mono16_bits = 0;

  /// Brings every value into its legal range and returns one sentence per value that was changed.
  std::vector<std::string> validate();
};

/// The side outputs to make; they cost time, so only what somebody listens to.
struct WantedOutputs {
  bool depth = false;
  bool overlay = false;
  bool disparity_color = false;
};

struct FrameResult {
  /// Used again for a later frame once nobody has it any more.
  stereo_msgs::DisparityImagePtr disparity;
  /// Complete but for `latency` and `frames_dropped`, which are the caller's to fill.
  GridStatePtr grid_state;

  /// The left image as CV_8UC1, which may be the message's own memory: valid as long as the pair.
  cv::Mat left;
  FlightState state;
  PathPlan plan;
  StageTimes times;
};

/// What is made of a frame's result once that has been published. Null unless wanted: 32FC1 [m];
/// bgr8; bgr8.
struct SideOutputs {
  sensor_msgs::ImagePtr depth;
  sensor_msgs::ImagePtr overlay;
  sensor_msgs::ImagePtr disparity_color;
};

/// One frame from the checked pair to the messages, without threads or topics: state, path plan,
/// matching, conversion. The nodelet and the offline tool share it. Same sequence of pairs, motions
/// and configs: same bits (times aside), as long as target_period is 0. Not thread safe.
class FrameProcessor {
 public:
  /// Throws std::invalid_argument unless config.validate() has nothing to change.
  explicit FrameProcessor(const ProcessorConfig& config);

  /// Effective from the next frame. Throws like the constructor; the old config stays.
  void setConfig(const ProcessorConfig& config);
  const ProcessorConfig& config() const { return config_; }

  /// pair: accepted by checkPair(), which also gave the geometry; motion: at the left image's
  /// stamp. Throws std::invalid_argument or cv::Exception if the pair cannot be processed after
  /// all.
  FrameResult process(const StereoPair& pair, const StereoGeometry& geometry, const Motion& motion);

  /// Changes nothing of the result, which others may read meanwhile. The governor counts what it
  /// takes as the next frame's.
  SideOutputs makeSideOutputs(const FrameResult& frame, const WantedOutputs& wanted);

  /// Ends the frame under way, and every later one, by MatchCancelled. May be called from any
  /// thread.
  void cancel() { matcher_.cancel(); }

  /// Forgets the flight state and the governor's history (stamps that start over).
  void reset();

 private:
  // A message that nobody else has.
  stereo_msgs::DisparityImagePtr freeMessage();

  ProcessorConfig config_;
  StereoMatcher matcher_;
  FlightStateMachine state_machine_;
  DeadlineGovernor governor_;
  double side_time_ = 0.0;  // of side outputs since the last frame [s]
  // Of the last frames; some may be with subscribers still.
  std::vector<stereo_msgs::DisparityImagePtr> messages_;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_ROS_FRAME_PROCESSOR_H
