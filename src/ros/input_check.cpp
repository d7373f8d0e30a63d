#include "adaptive_grid_stereo/ros/input_check.h"

#include <cmath>
#include <cstdio>

#include "adaptive_grid_stereo/matching/stereo_matcher.h"
#include "adaptive_grid_stereo/ros/conversions.h"
#include "adaptive_grid_stereo/ros/stamps.h"
#include "rectified_projection.h"

namespace adaptive_grid_stereo {
namespace {

/// fx of left and right may differ by this share before the pair counts as not rectified.
constexpr double kFocalTolerance = 1e-3;
/// No rig is wider [m].
constexpr double kLargestBaseline = 100.0;
/// No aircraft's cameras are farther apart; a small rig's baseline in millimetres is [m].
constexpr double kOddBaseline = 5.0;
/// Differences of the two stamps beyond this are mentioned [s].
constexpr double kOddStampDifference = 0.005;

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.6g", value);
  return text;
}

std::string size(unsigned width, unsigned height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

/// Thrown inside this file only, to leave the chain of checks.
struct Refusal {
  InputFault fault;
  std::string sentence;
};

void refuseIf(bool condition, InputFault fault, const std::string& sentence) {
  if (condition) throw Refusal{fault, sentence};
}

void checkImage(const sensor_msgs::Image& image, const std::string& topic) {
  const unsigned smallest = kMinImageSide;
  refuseIf(image.width < smallest || image.height < smallest || image.width > kMaxImageSide ||
               image.height > kMaxImageSide,
           InputFault::kDimensions,
           topic + " is " + size(image.width, image.height) + " pixels; sides of " +
               std::to_string(smallest) + " to " + std::to_string(kMaxImageSide) +
               " are accepted, so check the driver or the scaling before it");
  const std::string encoding_fault = encodingFault(image.encoding);
  refuseIf(!encoding_fault.empty(), InputFault::kEncoding, topic + " " + encoding_fault);
  const std::string fault = imageFault(image);
  refuseIf(!fault.empty(), InputFault::kDimensions,
           topic + " " + fault + "; the publisher fills the message wrongly");
}

void checkImages(const StereoPair& pair, const InputLimits& limits, const InputTopics& topics) {
  checkImage(*pair.left, topics.left_image);
  checkImage(*pair.right, topics.right_image);
  refuseIf(pair.left->width != pair.right->width || pair.left->height != pair.right->height,
           InputFault::kSizeMismatch,
           topics.left_image + " is " + size(pair.left->width, pair.left->height) + ", but " +
               topics.right_image + " is " + size(pair.right->width, pair.right->height) +
               "; set both cameras to one resolution");
  const double difference =
      std::abs(secondsBetween(pair.left->header.stamp, pair.right->header.stamp));
  refuseIf(limits.max_stamp_difference > 0.0 && difference > limits.max_stamp_difference,
           InputFault::kStampDifference,
           "the stamps of " + topics.left_image + " and " + topics.right_image + " differ by " +
               number(1e3 * difference) + " ms, more than approximate_sync_max_interval = " +
               number(1e3 * limits.max_stamp_difference) +
               " ms; trigger the cameras together, or raise the parameter");
}

void checkInfo(const sensor_msgs::CameraInfo& info, const RectifiedProjection& projection,
               const sensor_msgs::Image& image, const std::string& topic,
               const std::string& image_topic) {
  for (const double value : info.P) {
    refuseIf(
        !std::isfinite(value), InputFault::kUncalibrated,
        topic + " has " + number(value) + " in P; calibrate the cameras and publish the result");
  }
  refuseIf(info.P[0] <= 0.0, InputFault::kUncalibrated,
           topic + " is not calibrated (fx = P[0] = " + number(info.P[0]) +
               ", must be positive); calibrate the stereo rig, and let the driver load the result");
  refuseIf(projection.width != 0 && projection.height != 0 &&
               (projection.width != image.width || projection.height != image.height),
           InputFault::kSizeMismatch,
           topic + " describes an image of " + size(projection.width, projection.height) +
               ", but " + image_topic + " is " + size(image.width, image.height) +
               "; publish the camera_info that belongs to the image, or state binning and roi in "
               "it");
}

double checkBaseline(const RectifiedProjection& left, const RectifiedProjection& right,
                     const InputLimits& limits, const InputTopics& topics,
                     StereoGeometry& geometry) {
  if (limits.baseline > 0.0) {
    geometry.baseline_source = "parameter";
    return limits.baseline;
  }
  geometry.baseline_source = "camera_info";
  // Some drivers put the whole offset between both cameras' P; what counts is the difference.
  const double baseline = (left.tx - right.tx) / right.fx;
  refuseIf(baseline < 0.0, InputFault::kBaseline,
           topics.right_info + " gives a baseline of " + number(baseline) +
               " m (P[3] = " + number(right.tx) +
               " = -fx * baseline must be negative); are left and right swapped?");
  refuseIf(baseline < 1e-6, InputFault::kBaseline,
           topics.right_info + " gives a baseline of " + number(baseline) +
               " m (P[3] = " + number(right.tx) +
               ", expected -fx * baseline); publish the stereo calibration, or "
               "set the parameter baseline [m]");
  refuseIf(!(baseline <= kLargestBaseline), InputFault::kBaseline,
           topics.right_info + " gives a baseline of " + number(baseline) +
               " m (P[3] = " + number(right.tx) + ", P[0] = " + number(right.fx) +
               "); P[3] is -fx * baseline in pixels times metres, not millimetres, so check the "
               "calibration");
  return baseline;
}

void addWarnings(const StereoPair& pair, const InputTopics& topics, InputVerdict& verdict) {
  if (pair.left->header.frame_id != pair.right->header.frame_id) {
    verdict.warnings.push_back("frame_id is \"" + pair.left->header.frame_id + "\" on " +
                               topics.left_image + " and \"" + pair.right->header.frame_id +
                               "\" on " + topics.right_image +
                               "; the left one is used, but stereo_image_proc/point_cloud2 aborts "
                               "unless both camera_infos "
                               "name the same frame");
  }
  if (pair.left->header.frame_id.empty()) {
    verdict.warnings.push_back(topics.left_image +
                               " has no frame_id; neither tf nor rviz can place the disparity, so "
                               "set frame_id in the driver");
  }
  if (pair.left->header.stamp.isZero()) {
    verdict.warnings.push_back(
        topics.left_image +
        " has the stamp 0; without stamps the motion cannot be looked up, so "
        "let the driver fill header.stamp");
  }
  if (verdict.geometry.baseline > kOddBaseline) {
    verdict.warnings.push_back(
        "the baseline is " + number(verdict.geometry.baseline) + " m by " +
        (verdict.geometry.baseline_source == "parameter" ? "the parameter baseline"
                                                         : topics.right_info) +
        "; is that in millimetres? Ranges would be a thousand times too large");
  }
  const double difference =
      std::abs(secondsBetween(pair.left->header.stamp, pair.right->header.stamp));
  if (difference > kOddStampDifference) {
    verdict.warnings.push_back("the stamps of " + topics.left_image + " and " + topics.right_image +
                               " differ by more than " + number(1e3 * kOddStampDifference) +
                               " ms (now " + number(1e3 * difference) +
                               " ms); a turning camera moves several pixels in that time");
  }
}

}  // namespace

InputVerdict checkPair(const StereoPair& pair, const InputLimits& limits,
                       const InputTopics& topics) {
  InputVerdict verdict;
  try {
    refuseIf(!pair.left || !pair.right || !pair.left_info || !pair.right_info, InputFault::kMissing,
             "a message of the stereo pair is missing");
    checkImages(pair, limits, topics);
    const RectifiedProjection left = rectifiedProjection(*pair.left_info);
    const RectifiedProjection right = rectifiedProjection(*pair.right_info);
    checkInfo(*pair.left_info, left, *pair.left, topics.left_info, topics.left_image);
    checkInfo(*pair.right_info, right, *pair.right, topics.right_info, topics.right_image);
    refuseIf(std::abs(left.fx - right.fx) > kFocalTolerance * left.fx, InputFault::kFocalLength,
             topics.left_info + " has fx = P[0] = " + number(left.fx) + ", but " +
                 topics.right_info + " has " + number(right.fx) +
                 "; a rectified pair has one focal length, so calibrate both cameras together");
    refuseIf(
        !(std::abs(left.cx - right.cx) <= pair.left->width), InputFault::kUncalibrated,
        topics.left_info + " has cx = P[2] = " + number(left.cx) + ", but " + topics.right_info +
            " has " + number(right.cx) +
            "; they differ by more than the image's width, so calibrate both cameras together");
    verdict.geometry.baseline = checkBaseline(left, right, limits, topics, verdict.geometry);
    verdict.geometry.focal_length = right.fx;
    verdict.geometry.center_offset = left.cx - right.cx;
    addWarnings(pair, topics, verdict);
  } catch (const Refusal& refusal) {
    verdict.fault = refusal.fault;
    verdict.error = refusal.sentence;
  }
  return verdict;
}

}  // namespace adaptive_grid_stereo
