#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <boost/make_shared.hpp>

#include "adaptive_grid_stereo/ros/conversions.h"

namespace adaptive_grid_stereo {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// How often each fixed-point disparity occurs in a rectangle of the image.
void countDisparities(const cv::Mat& cell, std::vector<int>& histogram) {
  std::fill(histogram.begin(), histogram.end(), 0);
  const int largest = static_cast<int>(histogram.size()) - 1;
  for (int y = 0; y < cell.rows; ++y) {
    const auto* row = cell.ptr<std::int16_t>(y);
    for (int x = 0; x < cell.cols; ++x) {
      if (row[x] >= 0) ++histogram[std::min<int>(row[x], largest)];
    }
  }
}

/// The largest disparity that at least `enough` pixels reach; -1 if there are fewer.
int nearestDisparity(const std::vector<int>& histogram, long enough) {
  long sum = 0;
  for (int value = static_cast<int>(histogram.size()) - 1; value >= 0; --value) {
    sum += histogram[value];
    if (sum >= enough) return value;
  }
  return -1;
}

}  // namespace

CellStatistics cellStatistics(const MatchResult& result, const StereoGeometry& geometry,
                              const PathPlan& plan) {
  CellStatistics cells;
  std::vector<int> histogram(static_cast<std::size_t>(result.disparity_range) * kDisparityScale);
  for (int cell = 0; cell < 9; ++cell) {
    cells.density[cell] = kNan;
    cells.nearest_range[cell] = kNan;
    const cv::Rect area(cv::Point(plan.column_edges[cell % 3], plan.row_edges[cell / 3]),
                        cv::Point(plan.column_edges[cell % 3 + 1], plan.row_edges[cell / 3 + 1]));
    const long pixels = static_cast<long>(area.width) * area.height;
    if (pixels == 0) continue;

    countDisparities(result.disparity(area), histogram);
    long valid = 0;
    for (const int count : histogram) valid += count;
    cells.density[cell] = static_cast<float>(static_cast<double>(valid) / pixels);
    const long enough =
        std::max<long>(kNearestPixels, std::lround(kNearestShare * static_cast<double>(pixels)));
    const int nearest = nearestDisparity(histogram, enough);
    if (nearest < 0) continue;
    const double disparity = result.min_disparity - geometry.center_offset +
                             static_cast<double>(nearest) / kDisparityScale;
    cells.nearest_range[cell] =
        disparity > 0.0 ? static_cast<float>(geometry.focal_length * geometry.baseline / disparity)
                        : std::numeric_limits<float>::infinity();
  }
  return cells;
}

std::uint8_t toStateBits(const FlightState& state) {
  std::uint8_t bits = 0;
  if (!state.motion_known) return bits;
  if (state.locked) bits |= GridState::LOCKED;
  if (state.forward) bits |= GridState::FORWARD;
  if (state.yaw != YawSide::kNone) bits |= GridState::YAW;
  if (state.pitch != PitchSide::kNone) bits |= GridState::PITCH;
  return bits;
}

GridStatePtr toGridState(const std_msgs::Header& header, const Motion& motion,
                         const FlightState& state, const PathPlan& plan,
                         const CellStatistics& cells, const GuidanceConfig& config) {
  auto message = boost::make_shared<GridState>();
  message->header = header;
  message->state = toStateBits(state);
  message->motion_valid = motion.valid;
  message->speed_source = motion.speed_source;
  message->rate_source = motion.rate_source;
  message->motion_status = motion.reason;
  message->forward_speed = motion.forward_speed;
  message->yaw_rate = motion.yaw_rate;
  message->pitch_rate = motion.pitch_rate;
  message->speed_ratio = motion.forward_speed / config.max_speed;
  message->yaw_ratio = std::abs(motion.yaw_rate) / config.max_yaw_rate;
  message->pitch_ratio = std::abs(motion.pitch_rate) / config.max_pitch_rate;
  std::copy(plan.column_edges.begin(), plan.column_edges.end(), message->column_edges.begin());
  std::copy(plan.row_edges.begin(), plan.row_edges.end(), message->row_edges.begin());
  std::copy(plan.paths.begin(), plan.paths.end(), message->paths.begin());
  std::copy(cells.density.begin(), cells.density.end(), message->density.begin());
  std::copy(cells.nearest_range.begin(), cells.nearest_range.end(), message->nearest_range.begin());
  return message;
}

}  // namespace adaptive_grid_stereo
