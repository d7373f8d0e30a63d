#ifndef ADAPTIVE_GRID_STEREO_SRC_MATCHING_PATH_ROWS_H
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_PATH_ROWS_H

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "src/matching/aligned_buffer.h"
#include "src/matching/bands.h"
#include "src/matching/pixel_kinds.h"
#include "src/matching/sweep.h"

namespace adaptive_grid_stereo {

/// The rows that a band's paths go through: [kRowsAbove + row], null where the band has no such
/// row.
struct BandPathRows {
  std::array<PathRow, kPlacesPerStep> places{};
  /// PixelKinds::row() of each; null above the image, where all path costs are zero.
  std::array<const std::uint8_t*, kPlacesPerStep> kinds{};
  bool operator==(const BandPathRows& other) const {
    return places == other.places && kinds == other.kinds;
  }
};

/// Where the path costs of a sweep's rows lie: in as little memory as their readers allow, so that
/// it stays in the caches. A band leaves its last row to the next one, and of the row before it the
/// pixels of cells of 16 paths, as no other path skips a row; of the rest only the last few pixels
/// of a row are kept, in rings. Each strip writes over what it wrote for the band before. But for
/// pixels near a border between strips, which the neighbour may still read: there, bands take turns
/// (BandTurns).
class PathRows {
 public:
  /// Makes buffers for the size and for at most so many strips where they are too small. Path costs
  /// beyond the range are 255.
  void prepare(int width, const PathLayout& layout, int strips);

  /// Must be called before a sweep. edges: of its strips. kinds: must be as they are until the
  /// sweep ends; anew: whether they are others than in the last call. Returns whether what find()
  /// has told is not valid any more.
  bool assign(const Bands& bands, const std::vector<int>& edges, const PixelKinds& kinds,
              bool anew);

  /// The rows of a band, and the two above it.
  BandPathRows find(int band, const BandTurns& turns) const;

  /// Place of path costs that are all zero.
  std::uint8_t* zero() { return zero_.data(); }

 private:
  void placeRingsAndLastRows();
  void placeLastButOneRows();
  // The place of pixel i - kPathMargin in a boundary's last (0) or last but one row (1).
  std::uint8_t* boundaryPlace(int slot, int from_last, std::size_t i);
  // Sets of places in rings, one for each turn, over and over.
  int sets() const { return std::max(1, sets_); }
  PathRow rowOf(int band, int row, const BandTurns& turns) const;
  PathRow ringRow(std::size_t set, int row) const;
  PathRow zeros() const { return zero_row_.data() + kPathMargin; }

  int width_ = 0;
  int strips_ = 0;
  PathLayout layout_;
  std::size_t row_pixels_ = 0;
  int sets_ = 0;  // of rings, if strips take turns
  AlignedBuffer<std::uint8_t> boundary_;
  AlignedBuffer<std::uint8_t> rings_;    // of the sets, then one set of each strip's own
  AlignedBuffer<std::uint8_t> zero_;     // one pixel
  std::vector<std::uint8_t*> zero_row_;  // [u]
  Bands bands_;
  const PixelKinds* kinds_ = nullptr;
  std::vector<int> edges_;                  // of the strips that the rest is for
  std::vector<int> owners_;                 // the strip that alone touches a column, or none, [u]
  std::vector<std::uint8_t*> ring_places_;  // [set][row][u]
  std::vector<std::uint8_t*> last_places_;  // [slot][u]
  // Of rows of cells that keep pixels of a band's last row but one: [row of cells][set][u].
  std::vector<std::uint8_t*> last_but_one_places_;
  bool keeps_pixels_[3] = {};
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_PATH_ROWS_H
