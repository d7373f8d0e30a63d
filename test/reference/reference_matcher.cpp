#include "reference_matcher.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "adaptive_grid_stereo/matching/stereo_matcher.h"

namespace adaptive_grid_stereo {
namespace reference {

std::vector<std::uint64_t> census(const cv::Mat& image, CensusWindow window) {
  const int half_width = window == CensusWindow::k5x5 ? 2 : window == CensusWindow::k7x7 ? 3 : 4;
  const int half_height = window == CensusWindow::k5x5 ? 2 : 3;
  std::vector<std::uint64_t> strings;
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      std::uint64_t bits = 0;
      int bit = 0;
      for (int j = -half_height; j <= half_height; ++j) {
        for (int i = -half_width; i <= half_width; ++i) {
          if (i == 0 && j == 0) continue;
          const int u = std::clamp(x + i, 0, image.cols - 1);
          const int v = std::clamp(y + j, 0, image.rows - 1);
          if (image.at<uchar>(v, u) < image.at<uchar>(y, x)) bits |= std::uint64_t{1} << bit;
          ++bit;
        }
      }
      strings.push_back(bits);
    }
  }
  return strings;
}

Volume matchingCost(const std::vector<std::uint64_t>& left, const std::vector<std::uint64_t>& right,
                    int width, int height, const MatcherConfig& config) {
  Volume cost(width, height, config.disparity_range);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int k = 0; k < cost.range; ++k) {
        const int u = x - (config.min_disparity + k);
        cost.at(x, y, k) = u >= 0 && u < width
                               ? __builtin_popcountll(left[static_cast<size_t>(y) * width + x] ^
                                                      right[static_cast<size_t>(y) * width + u])
                               : static_cast<int>(config.census_window);
      }
    }
  }
  return cost;
}

int largePenalty(int grey_step, const MatcherConfig& config) {
  if (!config.adaptive_penalty) return std::min(config.penalty_large, kLargestPenalty);
  return std::clamp(config.penalty_large / std::max(1, grey_step), config.penalty_large_min,
                    kLargestPenalty);
}

const std::array<cv::Point, 16>& directions() {
  static const std::array<cv::Point, 16> kDirections = {{{1, 0},
                                                         {-1, 0},
                                                         {0, 1},
                                                         {0, -1},
                                                         {1, 1},
                                                         {-1, -1},
                                                         {-1, 1},
                                                         {1, -1},
                                                         {2, 1},
                                                         {-2, -1},
                                                         {-2, 1},
                                                         {2, -1},
                                                         {1, 2},
                                                         {-1, -2},
                                                         {-1, 2},
                                                         {1, -2}}};
  return kDirections;
}

int pathsAt(const PathPlan& plan, int x, int y) {
  int column = 0;
  while (x >= plan.column_edges[column + 1]) ++column;
  int row = 0;
  while (y >= plan.row_edges[row + 1]) ++row;
  return plan.paths[3 * row + column];
}

namespace {

// The path costs of one direction at every pixel whose cell uses it, added to the sums.
void addDirection(const Volume& cost, const cv::Mat& image, const PathPlan& plan,
                  const MatcherConfig& config, int index, Volume* sums) {
  const cv::Point r = directions()[index];
  const int width = cost.width, height = cost.height, range = cost.range;
  Volume path(width, height, range);
  const auto uses = [&](int x, int y) {
    return x >= 0 && x < width && y >= 0 && y < height && pathsAt(plan, x, y) > index;
  };
  for (int row = 0; row < height; ++row) {
    const int y = r.y >= 0 ? row : height - 1 - row;
    for (int column = 0; column < width; ++column) {
      const int x = r.x >= 0 ? column : width - 1 - column;
      if (!uses(x, y)) continue;
      const int xp = x - r.x, yp = y - r.y;
      const bool starts = !uses(xp, yp);
      int smallest = 0, p2 = 0;
      if (!starts) {
        smallest = path.at(xp, yp, 0);
        for (int k = 1; k < range; ++k) smallest = std::min(smallest, path.at(xp, yp, k));
        p2 = largePenalty(std::abs(image.at<uchar>(y, x) - image.at<uchar>(yp, xp)), config);
      }
      for (int k = 0; k < range; ++k) {
        int value = cost.at(x, y, k);
        if (!starts) {
          int best = std::min(path.at(xp, yp, k), smallest + p2);
          if (k > 0) best = std::min(best, path.at(xp, yp, k - 1) + config.penalty_small);
          if (k + 1 < range) best = std::min(best, path.at(xp, yp, k + 1) + config.penalty_small);
          value += best - smallest;
        }
        path.at(x, y, k) = value;
        sums->at(x, y, k) += value;
      }
    }
  }
}

int floorDivide(int numerator, int denominator) {
  return static_cast<int>(std::floor(static_cast<double>(numerator) / denominator));
}

}  // namespace

Volume aggregate(const Volume& cost, const cv::Mat& image, const PathPlan& plan,
                 const MatcherConfig& config) {
  Volume sums(cost.width, cost.height, cost.range);
  for (int index = 0; index < 16; ++index) {
    addDirection(cost, image, plan, config, index, &sums);
  }
  return sums;
}

cv::Mat select(const Volume& sums, const PathPlan& plan, const MatcherConfig& config) {
  const int width = sums.width, height = sums.height, range = sums.range;
  const int min_disparity = config.min_disparity;
  const auto inside = [&](int x, int k) {
    return k >= 0 && k < range && x - (min_disparity + k) >= 0 && x - (min_disparity + k) < width;
  };
  const int uniqueness_factor =
      static_cast<int>(std::lround(4096.0 * 100.0 / (100.0 - config.uniqueness_ratio)));
  cv::Mat disparity(height, width, CV_16SC1, cv::Scalar(kInvalidDisparity));
  for (int y = 0; y < height; ++y) {
    std::vector<int> left(width, -1), right(width, -1);
    for (int x = 0; x < width; ++x) {
      for (int k = 0; k < range; ++k) {
        if (inside(x, k) && (left[x] < 0 || sums.at(x, y, k) < sums.at(x, y, left[x]))) left[x] = k;
      }
    }
    std::vector<int> right_sum(width, 0);
    for (int x = 0; x < width; ++x) {
      const int k = left[x];
      if (k < 0) continue;
      const int u = x - (min_disparity + k);
      const int scaled = sums.at(x, y, k) * (16 / pathsAt(plan, x, y));
      if (right[u] < 0 || scaled < right_sum[u] || (scaled == right_sum[u] && k < right[u])) {
        right[u] = k;
        right_sum[u] = scaled;
      }
    }
    for (int x = 0; x < width; ++x) {
      const int k = left[x];
      if (k < 0) continue;
      const int best = sums.at(x, y, k);
      const long threshold = (static_cast<long>(best) * uniqueness_factor) >> 12;
      bool unique = true;
      for (int other = 0; other < range; ++other) {
        if (inside(x, other) && std::abs(other - k) > 1 && sums.at(x, y, other) < threshold) {
          unique = false;
        }
      }
      if (!unique) continue;
      int value = k * kDisparityScale;
      if (config.subpixel && inside(x, k - 1) && inside(x, k + 1)) {
        const int before = sums.at(x, y, k - 1), after = sums.at(x, y, k + 1);
        const int curvature = before + after - 2 * best;
        if (curvature > 0) {
          value += floorDivide((before - after) * kDisparityScale + curvature, 2 * curvature);
        }
      }
      const auto consistent = [&](int candidate) {
        const int u = x - (min_disparity + candidate);
        return u >= 0 && u < width && right[u] >= 0 &&
               std::abs(right[u] - candidate) <= config.disp12_max_diff;
      };
      if (config.disp12_max_diff >= 0 && !consistent(k) &&
          !consistent(floorDivide(value, kDisparityScale)) &&
          !consistent(floorDivide(value + kDisparityScale - 1, kDisparityScale))) {
        continue;
      }
      disparity.at<std::int16_t>(y, x) = static_cast<std::int16_t>(value);
    }
  }
  return disparity;
}

namespace {

// Where the standard deviation of the grey levels in the census window is below min_contrast.
void removeLowContrast(const cv::Mat& image, const MatcherConfig& config, cv::Mat* disparity) {
  const cv::Size window = config.census_window == CensusWindow::k5x5   ? cv::Size(5, 5)
                          : config.census_window == CensusWindow::k7x7 ? cv::Size(7, 7)
                                                                       : cv::Size(9, 7);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      double sum = 0.0, squares = 0.0;
      for (int j = -window.height / 2; j <= window.height / 2; ++j) {
        for (int i = -window.width / 2; i <= window.width / 2; ++i) {
          const double grey = image.at<uchar>(std::clamp(y + j, 0, image.rows - 1),
                                              std::clamp(x + i, 0, image.cols - 1));
          sum += grey;
          squares += grey * grey;
        }
      }
      // variance * n^2, exact in doubles; the limit is rounded to a whole number.
      const double n = window.area();
      if (squares * n - sum * sum < std::round(config.min_contrast * config.min_contrast * n * n)) {
        disparity->at<std::int16_t>(y, x) = kInvalidDisparity;
      }
    }
  }
}

// Four-connected regions of valid pixels whose neighbours differ by at most max_step; those of at
// most max_size pixels become invalid.
void removeSmallRegions(int max_size, int max_step, cv::Mat* disparity) {
  cv::Mat seen(disparity->size(), CV_8UC1, cv::Scalar(0));
  for (int y = 0; y < disparity->rows; ++y) {
    for (int x = 0; x < disparity->cols; ++x) {
      if (seen.at<uchar>(y, x) || disparity->at<std::int16_t>(y, x) == kInvalidDisparity) continue;
      std::vector<cv::Point> region = {{x, y}};
      seen.at<uchar>(y, x) = 1;
      for (size_t i = 0; i < region.size(); ++i) {
        const cv::Point p = region[i];
        for (const cv::Point step : {cv::Point(1, 0), {-1, 0}, {0, 1}, {0, -1}}) {
          const cv::Point q = p + step;
          if (q.x < 0 || q.y < 0 || q.x >= disparity->cols || q.y >= disparity->rows) continue;
          const int value = disparity->at<std::int16_t>(q);
          if (seen.at<uchar>(q) || value == kInvalidDisparity) continue;
          if (std::abs(value - disparity->at<std::int16_t>(p)) > max_step) continue;
          seen.at<uchar>(q) = 1;
          region.push_back(q);
        }
      }
      if (static_cast<int>(region.size()) <= max_size) {
        for (const cv::Point& p : region) disparity->at<std::int16_t>(p) = kInvalidDisparity;
      }
    }
  }
}

cv::Mat medianOfValid(const cv::Mat& disparity) {
  cv::Mat result = disparity.clone();
  for (int y = 0; y < disparity.rows; ++y) {
    for (int x = 0; x < disparity.cols; ++x) {
      const std::int16_t centre = disparity.at<std::int16_t>(y, x);
      if (centre == kInvalidDisparity) continue;
      std::vector<std::int16_t> values;
      for (int j = -1; j <= 1; ++j) {
        for (int i = -1; i <= 1; ++i) {
          const int u = x + i, v = y + j;
          const bool usable = u >= 0 && v >= 0 && u < disparity.cols && v < disparity.rows &&
                              disparity.at<std::int16_t>(v, u) != kInvalidDisparity;
          values.push_back(usable ? disparity.at<std::int16_t>(v, u) : centre);
        }
      }
      std::sort(values.begin(), values.end());
      result.at<std::int16_t>(y, x) = values[4];
    }
  }
  return result;
}

}  // namespace

cv::Mat refine(const cv::Mat& disparity, const cv::Mat& left, const MatcherConfig& config) {
  cv::Mat result = disparity.clone();
  if (config.min_contrast > 0.0) removeLowContrast(left, config, &result);
  if (config.speckle_size > 0) {
    removeSmallRegions(config.speckle_size, config.speckle_range * kDisparityScale, &result);
  }
  return config.median_filter ? medianOfValid(result) : result;
}

cv::Mat match(const cv::Mat& left, const cv::Mat& right, const PathPlan& plan,
              const MatcherConfig& config) {
  const Volume cost =
      matchingCost(census(left, config.census_window), census(right, config.census_window),
                   left.cols, left.rows, config);
  return refine(select(aggregate(cost, left, plan, config), plan, config), left, config);
}

}  // namespace reference
}  // namespace adaptive_grid_stereo
