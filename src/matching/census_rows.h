#ifndef ADAPTIVE_GRID_STEREO_SRC_MATCHING_CENSUS_ROWS_H
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_CENSUS_ROWS_H

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "adaptive_grid_stereo/matching/census.h"
#include "adaptive_grid_stereo/matching/padded_image.h"
#include "src/matching/aligned_buffer.h"
#include "src/matching/sweep.h"

namespace adaptive_grid_stereo {

/// The census strings of a frame's rows, in the order that the target's costs want: those of all
/// rows, or of as many as are used together, while they are in the caches.
class CensusRows {
 public:
  /// Makes buffers for the size where they are too small. Row y keeps its place until row y + kept
  /// is made.
  void prepare(int width, int kept, int threads) {
    row_bytes_ = censusRowBytes(width);
    kept_ = kept;
    for (auto* rows : {&left_, &right_}) {
      // What margins hold is of no importance, as long as it is something.
      if (rows->reserve(row_bytes_ * kept)) std::memset(rows->data(), 0, row_bytes_ * kept);
    }
    planes_.resize(threads);
    for (auto& planes : planes_) planes.resize(row_bytes_);
  }

  /// Makes rows [first, last). Thread safe for disjoint rows and different threads.
  void make(const PaddedImage& left, const PaddedImage& right_mirrored, CensusWindow window,
            int first, int last, int thread) {
    std::uint8_t* planes = planes_[thread].data();
    for (int y = first; y < last; ++y) {
      orderedCensusRow(left, false, y, window, planes, left_.data() + place(y));
      orderedCensusRow(right_mirrored, true, y, window, planes, right_.data() + place(y));
    }
  }

  const std::uint8_t* left(int y) const { return left_.data() + place(y); }
  const std::uint8_t* right(int y) const { return right_.data() + place(y); }

 private:
  std::size_t place(int y) const { return static_cast<std::size_t>(y % kept_) * row_bytes_; }

  std::size_t row_bytes_ = 0;
  int kept_ = 1;
  AlignedBuffer<std::uint8_t> left_, right_;
  std::vector<std::vector<std::uint8_t>> planes_;  // of a row, for each thread
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_CENSUS_ROWS_H
