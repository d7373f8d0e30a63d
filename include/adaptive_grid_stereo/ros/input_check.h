#ifndef ADAPTIVE_GRID_STEREO_ROS_INPUT_CHECK_H
#define ADAPTIVE_GRID_STEREO_ROS_INPUT_CHECK_H

#include <string>
#include <vector>

#include "adaptive_grid_stereo/ros/stereo_pair.h"

namespace adaptive_grid_stereo {

/// Largest image side that is accepted [px].
constexpr unsigned kMaxImageSide = 16384;

/// The kind of fault, so that repeated complaints of one kind can be held back.
enum class InputFault {
  kNone,
  kMissing,
  kDimensions,
  kEncoding,
  kSizeMismatch,
  kStampDifference,
  kUncalibrated,
  kFocalLength,
  kBaseline,
};

/// What the user states about his inputs.
struct InputLimits {
  /// Overrides the baseline of the camera_info [m]; 0: use the camera_info's.
  double baseline = 0.0;
  /// Largest |stamp of left - stamp of right| [s]; 0: no limit.
  double max_stamp_difference = 0.0;
};

/// Resolved topic names, for the sentences.
struct InputTopics {
  std::string left_image = "left/image_rect";
  std::string right_image = "right/image_rect";
  std::string left_info = "left/camera_info";
  std::string right_info = "right/camera_info";
};

struct InputVerdict {
  InputFault fault = InputFault::kNone;
  /// One sentence with topic, value found and cure; empty if the pair is good.
  std::string error;
  /// What is odd but harmless here; one sentence each.
  std::vector<std::string> warnings;
  /// Valid only if ok().
  StereoGeometry geometry;

  bool ok() const { return fault == InputFault::kNone; }
};

/// Whether the matcher can take this pair, and the geometry that its calibration gives. Pure; never
/// throws and never reads beyond a message's data, whatever its fields say.
InputVerdict checkPair(const StereoPair& pair, const InputLimits& limits,
                       const InputTopics& topics = InputTopics());

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_ROS_INPUT_CHECK_H
