#ifndef ADAPTIVE_GRID_STEREO_TEST_MATCHING_CHECKSUM_H
#define ADAPTIVE_GRID_STEREO_TEST_MATCHING_CHECKSUM_H

#include <cstdint>

#include <opencv2/core.hpp>

namespace adaptive_grid_stereo {

/// FNV-1a over the pixels of a CV_16SC1 image, low byte first, so that it is the same on every
/// machine. `sum` continues that of the images before.
inline std::uint64_t checksum(const cv::Mat& disparity,
                              std::uint64_t sum = 14695981039346656037ULL) {
  for (int y = 0; y < disparity.rows; ++y) {
    for (int x = 0; x < disparity.cols; ++x) {
      const unsigned value = static_cast<std::uint16_t>(disparity.at<std::int16_t>(y, x));
      for (const unsigned byte : {value & 255U, value >> 8U}) sum = (sum ^ byte) * 1099511628211ULL;
    }
  }
  return sum;
}

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_TEST_MATCHING_CHECKSUM_H
