#ifndef ADAPTIVE_GRID_STEREO_ROS_GOVERNOR_H
#define ADAPTIVE_GRID_STEREO_ROS_GOVERNOR_H

#include <vector>

#include "adaptive_grid_stereo/guidance/guidance_config.h"

namespace adaptive_grid_stereo {

/// Keeps the processing time below a target by taking paths away, and gives them back when there is
/// room. Steps: 0 full ladder, 1 at most 8/8/4 paths, 2 at most 8/4/4, 3 at most 4/4/4
/// (focus/near/far).
///
/// Down: the median of the last kWindow frames exceeds the target. Up: the median stayed below
/// kRoom * target for a number of frames in a row; that number doubles each time a step up had to
/// be taken back soon, so that the ladder does not swing. A function of the times given alone. Not
/// thread safe.
class DeadlineGovernor {
 public:
  static constexpr int kLastStep = 3;
  static constexpr int kWindow = 5;
  static constexpr double kRoom = 0.6;
  static constexpr int kShortestPatience = 10;
  static constexpr int kLongestPatience = 320;

  /// Counts one frame's processing time [s]; target [s], 0: governor off. Returns the step for the
  /// next frame.
  int update(double processing_time, double target_period);

  int step() const { return step_; }
  /// Median of the last frames [s]; 0 before the first.
  double median() const;
  void reset();

  /// The ladder of paths at a step: the same config with its path counts limited.
  static GuidanceConfig limitPaths(GuidanceConfig config, int step);

 private:
  void stepDown();
  void stepUp();

  int step_ = 0;
  std::vector<double> window_;
  int frames_with_room_ = 0;
  int frames_since_up_ = 1 << 20;  // never yet
  int patience_ = kShortestPatience;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_ROS_GOVERNOR_H
