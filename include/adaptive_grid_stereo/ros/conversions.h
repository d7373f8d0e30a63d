#ifndef ADAPTIVE_GRID_STEREO_ROS_CONVERSIONS_H
#define ADAPTIVE_GRID_STEREO_ROS_CONVERSIONS_H

#include <array>
#include <string>

#include <sensor_msgs/Image.h>
#include <sensor_msgs/RegionOfInterest.h>
#include <std_msgs/Header.h>
#include <stereo_msgs/DisparityImage.h>
#include <opencv2/core.hpp>

#include "adaptive_grid_stereo/GridState.h"
#include "adaptive_grid_stereo/guidance/flight_state.h"
#include "adaptive_grid_stereo/guidance/guidance_config.h"
#include "adaptive_grid_stereo/guidance/motion.h"
#include "adaptive_grid_stereo/matching/stereo_matcher.h"
#include "adaptive_grid_stereo/path_plan.h"
#include "adaptive_grid_stereo/ros/stereo_pair.h"

namespace adaptive_grid_stereo {

/// Empty if the image can be turned into grey and its sizes agree with its data; otherwise a
/// sentence without subject, e.g. "has step 100, less than 640 columns of 1 byte".
std::string imageFault(const sensor_msgs::Image& image);
/// Likewise for the encoding alone.
std::string encodingFault(const std::string& encoding);

struct GreyPair {
  cv::Mat left;
  cv::Mat right;
};

/// Both images as CV_8UC1. mono8 and 8UC1 are viewed in place: the Mat lives no longer than the
/// message and must not be written. Colours are weighed as cv::cvtColor does. Of 16-bit images the
/// 8 highest of their significant bits are kept, the same for both: `mono16_bits` of them, or, if
/// that is 0, the fewest of 8, 10, 12, 14 and 16 that hold the brightest pixel of the pair (so a
/// 12-bit camera does not go black). Throws std::invalid_argument if imageFault() has something to
/// say.
GreyPair toGreyPair(const sensor_msgs::Image& left, const sensor_msgs::Image& right,
                    int mono16_bits = 0);

/// Pixels that can have a disparity at all: those with a candidate inside the right image.
sensor_msgs::RegionOfInterest validWindow(int width, int height, int min_disparity,
                                          int disparity_range);

/// `header` is the left image's. Disparities are given for parallel axes: center_offset is taken
/// off once, also from min_disparity and max_disparity. Invalid pixels hold the one value
/// min_disparity - 1. If no pixel is invalid, the first one is made so, because
/// cv::reprojectImageTo3D (and with it stereo_image_proc/point_cloud2) takes the smallest value of
/// the image for the mark of invalid pixels and would drop the farthest surface. All of the message
/// is written anew; its memory is used again if it is large enough.
void fillDisparityImage(const MatchResult& result, const StereoGeometry& geometry,
                        const std_msgs::Header& header, stereo_msgs::DisparityImage* message);

/// Depth along the optical axis, 32FC1 [m] (REP-118): NaN where invalid, +Inf for disparities <= 0.
sensor_msgs::ImagePtr toDepthImage(const stereo_msgs::DisparityImage& disparity);

/// The disparity in colour, bgr8: near is red, far is blue, invalid is black.
sensor_msgs::ImagePtr toColorImage(const stereo_msgs::DisparityImage& disparity);

/// What one sees in each cell of a plan.
struct CellStatistics {
  /// Share of valid pixels [0..1]; NaN in an empty cell.
  std::array<float, 9> density{};
  /// Range that the nearest kNearestShare of the cell's pixels (at least kNearestPixels of them) do
  /// not exceed [m]; +Inf if that is at infinity, NaN with fewer valid pixels.
  std::array<float, 9> nearest_range{};
};
constexpr double kNearestShare = 0.002;
constexpr int kNearestPixels = 8;
CellStatistics cellStatistics(const MatchResult& result, const StereoGeometry& geometry,
                              const PathPlan& plan);

/// Bits of GridState::state.
std::uint8_t toStateBits(const FlightState& state);

/// Everything but governor_step, processing_time, latency and frames_dropped.
GridStatePtr toGridState(const std_msgs::Header& header, const Motion& motion,
                         const FlightState& state, const PathPlan& plan,
                         const CellStatistics& cells, const GuidanceConfig& config);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_ROS_CONVERSIONS_H
