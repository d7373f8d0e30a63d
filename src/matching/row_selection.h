#ifndef ADAPTIVE_GRID_STEREO_SRC_MATCHING_ROW_SELECTION_H
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_ROW_SELECTION_H

#include <cstdint>
#include <vector>

#include "adaptive_grid_stereo/matching/matcher_config.h"
#include "src/matching/sweep.h"

namespace adaptive_grid_stereo {

/// Buffers of selectRow, for one thread. Claims are sums and indices: sum << 10 | index.
struct RowBuffers {
  std::vector<std::int32_t> places, claims;  // [x] which right pixel, and by what
  std::vector<std::int32_t> right;           // the best claim to each right pixel
  std::vector<std::uint16_t> right_indices;  // its index
  std::vector<std::int32_t> questions;       // [x] the first of two right pixels
  std::vector<std::uint32_t> answers;        // [x] the indices of both, in halves, low first
};

/// Sub-pixel disparity and left-right check of one row's winners.
/// shifts: [x] log2(16 / paths) of each pixel, which brings sums of different cells to one scale.
/// disparity: width fixed-point values, kInvalidDisparity where there is none.
void selectRow(const WinnerRow& winners, const std::uint8_t* shifts, int width,
               const MatcherConfig& config, RowBuffers* buffers, std::int16_t* disparity);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_ROW_SELECTION_H
