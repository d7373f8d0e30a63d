#ifndef ADAPTIVE_GRID_STEREO_SRC_MATCHING_PATH_ROWS_H
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_PATH_ROWS_H

#include <cstddef>
#include <cstdint>
#include <vector>

#include "src/matching/aligned_buffer.h"
#include "src/matching/strips.h"
#include "src/matching/sweep.h"

namespace adaptive_grid_stereo {

/// Where the path costs of the two sweeps' rows lie: in as little memory as their readers allow, so
/// that it stays in the caches. A band leaves its last two rows, whole, to the next one; its other
/// rows keep only their last few pixels, in rings. Each strip writes over what it wrote for the
/// band before. But for pixels near a border between strips, which the neighbour may still read:
/// there, bands take turns.
class PathRows {
 public:
  /// Makes buffers for the size where they are too small. Path costs beyond the range are 255.
  void prepare(int width, const PathLayout& layout, int threads);

  /// Must be called before a sweep.
  void assign(bool second_sweep, const Strips& strips);

  /// Tells the places of row `row` of a band of row_count rows, and of the two rows above it.
  void find(bool second_sweep, int band, int row, int row_count, SweepRow* out) const;

 private:
  struct Places {
    std::vector<int> edges;               // of the strips that the rest is for
    std::vector<std::uint8_t*> boundary;  // [slot][last or last but one row][u]
    std::vector<std::uint8_t*> ring;      // [set][row][u]
  };

  PathRow rowOf(const Places& places, int band, int row, int row_count) const;

  int width_ = 0;
  int threads_ = 0;
  PathLayout layout_;
  std::size_t row_pixels_ = 0;
  int sets_ = 0;  // of rings that bands take turns with
  AlignedBuffer<std::uint8_t> boundary_;
  AlignedBuffer<std::uint8_t> rings_;    // of the sets, then one set of each strip's own
  AlignedBuffer<std::uint8_t> zero_;     // one pixel
  std::vector<std::uint8_t*> zero_row_;  // [u]
  Places places_[2];
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_PATH_ROWS_H
