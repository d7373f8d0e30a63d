#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <boost/make_shared.hpp>
#include <opencv2/core/hal/intrin.hpp>

#include "adaptive_grid_stereo/ros/conversions.h"

namespace adaptive_grid_stereo {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// Fixed-point disparities of neighbouring pixels that are looked at together.
constexpr int kBlock = 32;

/// The largest disparity of a block, and how many of its pixels are valid.
struct BlockSummary {
  int largest, valid;
};

BlockSummary summarize(const std::int16_t* block) {
  constexpr int kLanes = cv::v_int16x8::nlanes;
  cv::v_int16x8 largest = cv::v_load(block);
  cv::v_int16x8 valid = largest >= cv::v_setzero_s16();
  for (int i = kLanes; i < kBlock; i += kLanes) {
    const cv::v_int16x8 values = cv::v_load(block + i);
    largest = cv::v_max(largest, values);
    valid += values >= cv::v_setzero_s16();
  }
  return {cv::v_reduce_max(largest), -cv::v_reduce_sum(valid)};
}

/// Counts the valid pixels of a cell, and finds the largest fixed-point disparity that at least so
/// many of them reach. Only pixels nearer than the best so far go into the histogram: in most
/// blocks there is none.
class CellSurvey {
 public:
  /// Of disparities 0 .. size - 1; larger ones count as the last.
  explicit CellSurvey(int size) : counts_(size) {}

  /// Looks at a cell (CV_16SC1) for what at least `enough` >= 1 of its pixels reach.
  void run(const cv::Mat& cell, long enough) {
    std::fill(counts_.begin(), counts_.end(), 0);
    nearest_ = -1;
    nearer_ = valid_ = 0;
    // From below, where the ground is nearest.
    for (int y = cell.rows - 1; y >= 0; --y) {
      const auto* row = cell.ptr<std::int16_t>(y);
      int x = 0;
      for (; x + kBlock <= cell.cols; x += kBlock) {
        const BlockSummary block = summarize(row + x);
        valid_ += block.valid;
        if (block.largest > nearest_) add(row + x, kBlock, enough);
      }
      valid_ += std::count_if(row + x, row + cell.cols, [](int value) { return value >= 0; });
      add(row + x, cell.cols - x, enough);
    }
  }

  long valid() const { return valid_; }
  /// Negative if fewer pixels than enough are valid.
  int nearest() const { return nearest_; }

 private:
  void add(const std::int16_t* values, int count, long enough) {
    for (int i = 0; i < count; ++i) {
      const int value = std::min<int>(values[i], static_cast<int>(counts_.size()) - 1);
      if (value <= nearest_) continue;
      ++counts_[value];
      ++nearer_;
    }
    while (nearer_ >= enough) nearer_ -= counts_[++nearest_];
  }

  std::vector<int> counts_;
  int nearest_ = -1;  // of the pixels so far
  long nearer_ = 0;   // how many are nearer than that
  long valid_ = 0;
};

}  // namespace

CellStatistics cellStatistics(const MatchResult& result, const StereoGeometry& geometry,
                              const PathPlan& plan) {
  CellStatistics cells;
  CellSurvey survey(result.disparity_range * kDisparityScale);
  for (int cell = 0; cell < 9; ++cell) {
    cells.density[cell] = kNan;
    cells.nearest_range[cell] = kNan;
    const cv::Rect area(cv::Point(plan.column_edges[cell % 3], plan.row_edges[cell / 3]),
                        cv::Point(plan.column_edges[cell % 3 + 1], plan.row_edges[cell / 3 + 1]));
    const long pixels = static_cast<long>(area.width) * area.height;
    if (pixels == 0) continue;

    const long enough =
        std::max<long>(kNearestPixels, std::lround(kNearestShare * static_cast<double>(pixels)));
    survey.run(result.disparity(area), enough);
    cells.density[cell] = static_cast<float>(static_cast<double>(survey.valid()) / pixels);
    const int nearest = survey.nearest();
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
