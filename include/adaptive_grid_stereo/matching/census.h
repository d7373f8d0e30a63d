#ifndef ADAPTIVE_GRID_STEREO_MATCHING_CENSUS_H
#define ADAPTIVE_GRID_STEREO_MATCHING_CENSUS_H

#include <cstddef>
#include <cstdint>

#include "adaptive_grid_stereo/matching/matcher_config.h"
#include "adaptive_grid_stereo/matching/padded_image.h"

namespace adaptive_grid_stereo {

/// Bytes in a census string of that window: 3, 6 or 8.
constexpr int censusPlanes(CensusWindow window) { return (static_cast<int>(window) + 7) / 8; }

/// Bytes before pixel 0 of a row of census planes, and at least as many after its last pixel, so
/// that whole vectors may be read there.
constexpr int kCensusMargin = 64;

/// Bytes from one census plane of a row to the next, for `width` pixels.
constexpr std::size_t censusStride(int width) {
  return (static_cast<std::size_t>(width) + 63) / 64 * 64 + 2 * kCensusMargin;
}

/// Census transform (eq. 2, 3) of row y: bit i of the string, counted row by row over the window
/// without its centre, is I(neighbour) < I(centre); borders replicate the edge. Bit i stands in
/// plane i / 8, the first of its bits highest. `mirrored` says that the image was assigned so; bits
/// keep the order of the unmirrored window. `planes` receives censusPlanes(window) rows of
/// censusStride(width) bytes; the byte of column x of plane p is planes[p * stride + kCensusMargin
/// + x]. Thread safe for different `planes`.
void censusRow(const PaddedImage& image, bool mirrored, int y, CensusWindow window,
               std::uint8_t* planes);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_MATCHING_CENSUS_H
