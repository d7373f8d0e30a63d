#ifndef ADAPTIVE_GRID_STEREO_SRC_COMMON_EIGHT_BITS_H
#define ADAPTIVE_GRID_STEREO_SRC_COMMON_EIGHT_BITS_H

#include <algorithm>
#include <cstdint>

#include <opencv2/core.hpp>

namespace adaptive_grid_stereo {

/// The brightest pixel of a CV_16UC1 image; 0 of one of 8 bits.
inline double brightest(const cv::Mat& grey) {
  if (grey.depth() != CV_16U) return 0.0;
  double largest = 0.0;
  cv::minMaxLoc(grey, nullptr, &largest);
  return largest;
}

/// The 8 highest of the `bits` lowest bits of a CV_16UC1 image, as CV_8UC1; one of 8 bits stays as
/// it is.
inline cv::Mat keepHighBits(const cv::Mat& grey, int bits) {
  if (grey.depth() == CV_8U) return grey;
  const int shift = std::max(0, bits - 8);
  cv::Mat result(grey.size(), CV_8UC1);
  for (int y = 0; y < grey.rows; ++y) {
    const auto* from = grey.ptr<std::uint16_t>(y);
    auto* to = result.ptr<std::uint8_t>(y);
    for (int x = 0; x < grey.cols; ++x) {
      to[x] = static_cast<std::uint8_t>(std::min(from[x] >> shift, 255));
    }
  }
  return result;
}

/// Makes CV_8UC1 of both images of a pair, CV_8UC1 or CV_16UC1: of 16 bits the 8 highest of `bits`
/// significant ones, or, if that is 0, of the fewest of 8, 10, 12, 14 and 16 that hold the
/// brightest pixel of the pair (so a 12-bit camera does not go black).
inline void keepEightBits(int bits, cv::Mat* left, cv::Mat* right) {
  if (bits == 0) {
    const double largest = std::max(brightest(*left), brightest(*right));
    bits = 8;
    while (bits < 16 && largest >= static_cast<double>(1 << bits)) bits += 2;
  }
  *left = keepHighBits(*left, bits);
  *right = keepHighBits(*right, bits);
}

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SRC_COMMON_EIGHT_BITS_H
