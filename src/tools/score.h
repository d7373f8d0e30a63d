#ifndef ADAPTIVE_GRID_STEREO_TOOLS_SCORE_H
#define ADAPTIVE_GRID_STEREO_TOOLS_SCORE_H

#include <array>
#include <vector>

#include <opencv2/core.hpp>

namespace adaptive_grid_stereo {

/// A pixel is bad if its disparity is off by more than so much [px].
constexpr std::array<float, 5> kBadThresholds{{0.5f, 1.0f, 2.0f, 3.0f, 4.0f}};

/// The error of one disparity map over one set of pixels.
struct Score {
  long pixels = 0;                    // scored
  std::array<double, 5> bad{};        // share of bad pixels, those without disparity being bad [%]
  std::array<double, 5> bad_valid{};  // likewise among the pixels that have a disparity [%]
  double average_error = 0.0;         // over the pixels that have a disparity [px]
  double density = 0.0;               // share of pixels that have a disparity [%]
};

/// Scores `disparity` against `truth` (both CV_32FC1 [px], not finite = unknown) over the pixels
/// where `mask` (CV_8UC1) is not 0, the truth is known, and which lie inside `box`.
Score score(const cv::Mat& disparity, const cv::Mat& truth, const cv::Mat& mask,
            const cv::Rect& box);

/// The mean of the scores that have pixels, each scene counting the same; `pixels` is their sum.
Score meanScore(const std::vector<Score>& scores);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_TOOLS_SCORE_H
