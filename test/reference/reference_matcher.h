#ifndef ADAPTIVE_GRID_STEREO_TEST_REFERENCE_REFERENCE_MATCHER_H
#define ADAPTIVE_GRID_STEREO_TEST_REFERENCE_REFERENCE_MATCHER_H

// The matcher as the paper's equations read: slow, plain, one function per stage. The fast kernels
// must give the same bits.

#include <array>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "adaptive_grid_stereo/matching/matcher_config.h"
#include "adaptive_grid_stereo/path_plan.h"

namespace adaptive_grid_stereo {
namespace reference {

/// A value per pixel and disparity index k (disparity = min_disparity + k).
struct Volume {
  Volume(int width, int height, int range)
      : width(width),
        height(height),
        range(range),
        data(static_cast<size_t>(width) * height * range) {}
  int& at(int x, int y, int k) { return data[(static_cast<size_t>(y) * width + x) * range + k]; }
  int at(int x, int y, int k) const {
    return data[(static_cast<size_t>(y) * width + x) * range + k];
  }
  int width, height, range;
  std::vector<int> data;
};

/// Eq. 2, 3: bit = neighbour < centre, row by row over the window without its centre, first bit
/// lowest; borders replicate the edge. Row-major, width * height strings.
std::vector<std::uint64_t> census(const cv::Mat& image, CensusWindow window);

/// Eq. 4: Hamming distance of left (x, y) and right (x - d, y); the number of bits where x - d
/// leaves the image.
Volume matchingCost(const std::vector<std::uint64_t>& left, const std::vector<std::uint64_t>& right,
                    int width, int height, const MatcherConfig& config);

/// Eq. 7 with its limits, for a grey-level step.
int largePenalty(int grey_step, const MatcherConfig& config);

/// The 16 directions r = (dx, dy) of a path's step from p - r to p: the first 4, 8 or 16 are those
/// of a cell with so many paths.
const std::array<cv::Point, 16>& directions();

/// Number of paths of the cell that holds (x, y).
int pathsAt(const PathPlan& plan, int x, int y);

/// Eq. 6 along each direction, summed over the directions of each pixel's cell.
Volume aggregate(const Volume& cost, const cv::Mat& image, const PathPlan& plan,
                 const MatcherConfig& config);

/// Winner-takes-all, uniqueness, sub-pixel and left-right check: CV_16SC1 fixed point as
/// MatchResult. Several left winners may claim one right pixel; the smallest sum, brought to the
/// scale of 16 paths, has it (the smaller disparity if equal). A left pixel is consistent if the
/// right pixel at its winner, or at its sub-pixel disparity rounded down or up, has a disparity
/// within disp12_max_diff.
cv::Mat select(const Volume& sums, const PathPlan& plan, const MatcherConfig& config);

/// Removal of low contrast, of small regions, and 3x3 median, by config. left: the image of the
/// disparities.
cv::Mat refine(const cv::Mat& disparity, const cv::Mat& left, const MatcherConfig& config);

/// All stages.
cv::Mat match(const cv::Mat& left, const cv::Mat& right, const PathPlan& plan,
              const MatcherConfig& config);

}  // namespace reference
}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_TEST_REFERENCE_REFERENCE_MATCHER_H
