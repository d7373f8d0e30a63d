#ifndef ADAPTIVE_GRID_STEREO_MATCHING_STEREO_MATCHER_H
#define ADAPTIVE_GRID_STEREO_MATCHING_STEREO_MATCHER_H

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>

#include <opencv2/core.hpp>

#include "adaptive_grid_stereo/matching/matcher_config.h"
#include "adaptive_grid_stereo/matching/simd_target.h"
#include "adaptive_grid_stereo/path_plan.h"

namespace adaptive_grid_stereo {

/// Smallest image side [px].
constexpr int kMinImageSide = 16;

/// Value of a pixel without disparity in MatchResult::disparity: one pixel below the smallest.
constexpr std::int16_t kInvalidDisparity = -kDisparityScale;

/// Wall-clock time of the stages of one frame [ms].
struct StageTimes {
  double census = 0.0;
  /// Matching cost, aggregation and disparity selection, which share two sweeps over the image.
  double sweeps = 0.0;
  double refinement = 0.0;
  double total = 0.0;
};

struct MatchResult {
  /// CV_16SC1, fixed point: disparity [px] = min_disparity + value / kDisparityScale, or
  /// kInvalidDisparity, which the same formula maps to min_disparity - 1.
  cv::Mat disparity;
  int min_disparity = 0;
  int disparity_range = 0;
  StageTimes times;
};

/// What match() throws after cancel().
struct MatchCancelled : std::runtime_error {
  MatchCancelled() : std::runtime_error("the matcher was told to stop") {}
};

/// Census semi-global matching with a path plan. Owns its buffers and its threads; buffers are made
/// anew only when the image's size or the disparity range grows. Not thread safe: one matcher, one
/// caller at a time, but for cancel(). Results are the same bits for any number of threads and any
/// SIMD target.
class StereoMatcher {
 public:
  /// Throws std::invalid_argument if config.validate() would change anything.
  explicit StereoMatcher(const MatcherConfig& config);
  ~StereoMatcher();
  StereoMatcher(const StereoMatcher&) = delete;
  StereoMatcher& operator=(const StereoMatcher&) = delete;

  /// Effective from the next match(). Throws like the constructor, the old config stays.
  void setConfig(const MatcherConfig& config);
  const MatcherConfig& config() const;

  /// left, right: rectified CV_8UC1 of one size, at least kMinImageSide a side; plan: for that
  /// size. The result belongs to the matcher and is overwritten by the next call. Throws
  /// std::invalid_argument with the value found if the images or the plan are not so, and
  /// MatchCancelled after cancel().
  const MatchResult& match(const cv::Mat& left, const cv::Mat& right, const PathPlan& plan);

  /// Ends the match() under way within a few image rows' work, and every later one: for a shutdown
  /// that must not wait for a large frame. May be called from any thread.
  void cancel();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Disparity in pixels: CV_32FC1 of the result's size, invalid pixels = min_disparity - 1 (never
/// NaN).
cv::Mat toFloatDisparity(const MatchResult& result);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_MATCHING_STEREO_MATCHER_H
