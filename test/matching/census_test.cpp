#include "adaptive_grid_stereo/matching/census.h"

#include <gtest/gtest.h>

#include "adaptive_grid_stereo/matching/simd_target.h"
#include "test/reference/reference_matcher.h"

namespace adaptive_grid_stereo {
namespace {

// The census string of column x from the planes of a row.
std::uint64_t stringAt(const std::vector<std::uint8_t>& planes, std::size_t stride,
                       CensusWindow window, int x) {
  std::uint64_t bits = 0;
  const int count = static_cast<int>(window);
  for (int i = 0; i < count; ++i) {
    const int in_plane = std::min(8, count - i / 8 * 8);
    const std::uint8_t byte = planes[i / 8 * stride + kCensusMargin + x];
    bits |= static_cast<std::uint64_t>((byte >> (in_plane - 1 - i % 8)) & 1) << i;
  }
  return bits;
}

TEST(Census, equalsItsEquation) {
  cv::RNG rng(4);
  for (const std::string& target : simdTargets()) {
    useSimdTarget(target);
    for (const CensusWindow window : {CensusWindow::k5x5, CensusWindow::k7x7, CensusWindow::k9x7}) {
      for (const cv::Size size : {cv::Size(16, 16), cv::Size(67, 19), cv::Size(128, 17)}) {
        cv::Mat image(size, CV_8UC1);
        rng.fill(image, cv::RNG::UNIFORM, 0, 256);
        const std::vector<std::uint64_t> expected = reference::census(image, window);
        const std::size_t stride = censusStride(size.width);
        std::vector<std::uint8_t> planes(stride * censusPlanes(window));
        for (const bool mirrored : {false, true}) {
          PaddedImage padded;
          padded.assign(image, mirrored);
          for (int y = 0; y < size.height; ++y) {
            censusRow(padded, mirrored, y, window, planes.data());
            for (int x = 0; x < size.width; ++x) {
              const int column = mirrored ? size.width - 1 - x : x;
              ASSERT_EQ(expected[static_cast<std::size_t>(y) * size.width + x],
                        stringAt(planes, stride, window, column))
                  << target << " " << toString(window) << " x " << x << " y " << y;
            }
          }
        }
      }
    }
  }
  useSimdTarget("");
}

TEST(Census, comparesStrictly) {
  const cv::Mat flat(16, 16, CV_8UC1, cv::Scalar(100));
  for (const std::uint64_t bits : reference::census(flat, CensusWindow::k9x7)) EXPECT_EQ(0u, bits);
}

}  // namespace
}  // namespace adaptive_grid_stereo
