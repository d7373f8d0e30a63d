#ifndef ADAPTIVE_GRID_STEREO_TEST_MATCHING_MATCHER_CHECKS_H
#define ADAPTIVE_GRID_STEREO_TEST_MATCHING_MATCHER_CHECKS_H

#include <array>
#include <cstdint>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "adaptive_grid_stereo/path_plan.h"

namespace adaptive_grid_stereo {

inline PathPlan plan(const std::array<int, 4>& columns, const std::array<int, 4>& rows,
                     const std::array<int, 9>& paths) {
  PathPlan result;
  result.column_edges = columns;
  result.row_edges = rows;
  result.paths = paths;
  return result;
}

/// Whether two CV_16SC1 images are equal; if not, the first pixel that differs.
inline testing::AssertionResult sameBits(const cv::Mat& expected, const cv::Mat& actual) {
  if (expected.size() != actual.size() || expected.type() != actual.type()) {
    return testing::AssertionFailure() << "sizes or types differ";
  }
  int different = 0;
  std::string first;
  for (int y = 0; y < expected.rows; ++y) {
    for (int x = 0; x < expected.cols; ++x) {
      const int e = expected.at<std::int16_t>(y, x), a = actual.at<std::int16_t>(y, x);
      if (e == a) continue;
      if (different++ == 0) {
        first = "(" + std::to_string(x) + ", " + std::to_string(y) + "): expected " +
                std::to_string(e) + ", got " + std::to_string(a);
      }
    }
  }
  if (different == 0) return testing::AssertionSuccess();
  return testing::AssertionFailure() << different << " pixels differ, first " << first;
}

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_TEST_MATCHING_MATCHER_CHECKS_H
