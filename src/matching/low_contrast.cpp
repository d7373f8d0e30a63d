#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "adaptive_grid_stereo/matching/refinement.h"
#include "adaptive_grid_stereo/matching/stereo_matcher.h"

namespace adaptive_grid_stereo {

void removeLowContrast(const PaddedImage& left, CensusWindow window, double min_contrast,
                       int first_row, int last_row, cv::Mat* disparity) {
  const int half_width = window == CensusWindow::k5x5 ? 2 : window == CensusWindow::k7x7 ? 3 : 4;
  const int half_height = window == CensusWindow::k5x5 ? 2 : 3;
  const int pixels = (2 * half_width + 1) * (2 * half_height + 1);
  // variance < min_contrast^2, times pixels^2, in integers: the same on every machine.
  const std::int64_t limit = std::llround(min_contrast * min_contrast * pixels * pixels);
  const int columns = left.width() + 2 * half_width;
  std::vector<std::int32_t> sums(columns), squares(columns);
  for (int y = first_row; y < last_row; ++y) {
    std::fill(sums.begin(), sums.end(), 0);
    std::fill(squares.begin(), squares.end(), 0);
    for (int j = -half_height; j <= half_height; ++j) {
      const std::uint8_t* row = left.row(y + j) - half_width;
      for (int i = 0; i < columns; ++i) {
        const int grey = row[i];
        sums[i] += grey;
        squares[i] += grey * grey;
      }
    }
    std::int16_t* values = disparity->ptr<std::int16_t>(y);
    std::int64_t sum = 0, square = 0;
    for (int i = 0; i < 2 * half_width; ++i) {
      sum += sums[i];
      square += squares[i];
    }
    for (int x = 0; x < left.width(); ++x) {
      sum += sums[x + 2 * half_width];
      square += squares[x + 2 * half_width];
      if (square * pixels - sum * sum < limit) values[x] = kInvalidDisparity;
      sum -= sums[x];
      square -= squares[x];
    }
  }
}

}  // namespace adaptive_grid_stereo
