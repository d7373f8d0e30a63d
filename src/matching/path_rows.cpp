#include "src/matching/path_rows.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "src/matching/strips.h"

namespace adaptive_grid_stereo {
namespace {

// Pixels of path costs that a row inside a band keeps: more than the reach of two rows below it,
// 2 * kBandLag + 1, and a power of two.
constexpr int kRingPixels = 8;
static_assert(2 * kBandLag + 2 <= kRingPixels, "a ring must hold what the rows below still need");
static_assert(kBandRows >= 2, "the two rows above a band come from one band");

// Bands that take turns with the boundary's pixels near a border between strips. Two are enough: a
// strip writes kBandLag * 2 pixels and more behind its step, and comes within Strips::kReach of the
// next strip only when that one is as far in the band above. Elsewhere one is enough: row 0 reads
// up to kPathMargin behind its step, row 1 up to kBandLag + 1, and no other row reads there.
constexpr int kBoundaries = 2;
static_assert(2 * kBandLag > kBandLag + 1 && 2 * kBandLag > kPathMargin,
              "what a band writes over must have been read");

// Pixels on either side of a border between strips that both sides may touch: a band's last row is
// so far behind its first one, and paths reach kPathMargin farther.
constexpr int kSharedPixels = Strips::kReach;

// The ring of a band's last row but one, wherever that is: no other row before the last one has it.
constexpr int kSpareRing = kBandRows - 2;

// Whether the next band reads a pixel of the last row but one, by the directions that skip a row.
bool isKept(std::uint8_t kind) { return kind == kEight; }

constexpr int kShared = -1;

// The strip that alone touches column u, or kShared.
int ownerOf(const std::vector<int>& edges, int u) {
  const int inner_edges = static_cast<int>(edges.size()) - 2;
  int strip = 0;
  for (int i = 1; i <= inner_edges; ++i) {
    if (std::abs(u - edges[i]) <= kSharedPixels) return kShared;
    if (u >= edges[i]) strip = i;
  }
  return strip;
}

}  // namespace

void PathRows::prepare(int width, const PathLayout& layout, int strips) {
  const bool moved = layout.range != layout_.range || layout.padded_range != layout_.padded_range;
  bool changed = moved || width != width_ || strips != strips_;
  width_ = width;
  strips_ = strips;
  layout_ = layout;
  row_pixels_ = static_cast<std::size_t>(width) + 2 * kPathMargin;
  // The first and the last strip are up to so many bands apart.
  sets_ = strips == 1 ? 0 : 2 * strips + 2;
  static_assert(kBoundaries == 2, "or else a set would not belong to one boundary");
  const auto reserve = [&](std::size_t pixels, AlignedBuffer<std::uint8_t>* buffer) {
    // Neighbours of the last disparity are read one byte further.
    const std::size_t bytes = pixels * layout.pixel_stride + kMaxLanes;
    const bool grew = buffer->reserve(bytes);
    if (grew || moved) std::memset(buffer->data(), 255, bytes);
    changed = changed || grew;
  };
  reserve(2 * kBoundaries * row_pixels_, &boundary_);
  reserve(static_cast<std::size_t>(sets_ + strips) * kBandRows * kRingPixels, &rings_);
  reserve(1, &zero_);
  if (!changed) return;
  std::memset(zero_.data(), 0, kPixelHeader);
  for (int r = 0; r < kSweepDirections; ++r) {
    std::memset(zero_.data() + kPixelHeader + r * layout.padded_range, 0, layout.range);
  }
  zero_row_.assign(row_pixels_, zero_.data());
  edges_.clear();
}

bool PathRows::assign(const Bands& bands, const std::vector<int>& edges, const PixelKinds& kinds,
                      bool anew) {
  bands_ = bands;
  kinds_ = &kinds;
  const bool moved = edges_ != edges;
  if (!moved && !anew) return false;
  if (moved) {
    edges_.clear();  // no edges, until all that is made from them is there
    owners_.resize(row_pixels_);
    for (std::size_t i = 0; i < row_pixels_; ++i) {
      owners_[i] = ownerOf(edges, static_cast<int>(i) - kPathMargin);
    }
    placeRingsAndLastRows();
  }
  placeLastButOneRows();
  edges_ = edges;
  return true;
}

std::uint8_t* PathRows::boundaryPlace(int slot, int from_last, std::size_t i) {
  const std::size_t row = (owners_[i] == kShared ? 2 * slot : 0) + from_last;
  return boundary_.data() + (row * row_pixels_ + i) * layout_.pixel_stride;
}

void PathRows::placeRingsAndLastRows() {
  // All pixels outside of the image share one place of zeros, which nobody writes to.
  ring_places_.assign(static_cast<std::size_t>(sets()) * kBandRows * row_pixels_, zero_.data());
  std::uint8_t** places = ring_places_.data();
  for (int set = 0; set < sets(); ++set) {
    for (int row = 0; row < kBandRows; ++row, places += row_pixels_) {
      for (std::size_t i = kPathMargin; i < row_pixels_ - kPathMargin; ++i) {
        const int rings = owners_[i] == kShared ? set : sets_ + owners_[i];
        const std::size_t ring = static_cast<std::size_t>(rings) * kBandRows + row;
        places[i] = rings_.data() + (ring * kRingPixels + i % kRingPixels) * layout_.pixel_stride;
      }
    }
  }
  last_places_.assign(kBoundaries * row_pixels_, zero_.data());
  for (int slot = 0; slot < kBoundaries; ++slot) {
    places = last_places_.data() + slot * row_pixels_;
    for (std::size_t i = kPathMargin; i < row_pixels_ - kPathMargin; ++i) {
      places[i] = boundaryPlace(slot, 0, i);
    }
  }
}

void PathRows::placeLastButOneRows() {
  last_but_one_places_.resize(3 * static_cast<std::size_t>(sets()) * row_pixels_);
  for (int cell = 0; cell < 3; ++cell) {
    const std::uint8_t* kinds = kinds_->ofCells(cell) - kPathMargin;
    keeps_pixels_[cell] = std::any_of(kinds, kinds + row_pixels_, isKept);
    for (int set = 0; set < sets() && keeps_pixels_[cell]; ++set) {
      const std::size_t ring = static_cast<std::size_t>(set) * kBandRows + kSpareRing;
      const std::size_t row = static_cast<std::size_t>(cell) * sets() + set;
      std::uint8_t** places = last_but_one_places_.data() + row * row_pixels_;
      std::copy_n(ring_places_.data() + ring * row_pixels_, row_pixels_, places);
      for (std::size_t i = kPathMargin; i < row_pixels_ - kPathMargin; ++i) {
        if (isKept(kinds[i])) places[i] = boundaryPlace(set % kBoundaries, 1, i);
      }
    }
  }
}

PathRow PathRows::rowOf(int band, int row, const BandTurns& turns) const {
  if (row < 0) {
    const int of_above = band == 0 ? -1 : bands_.rows(band - 1) + row;
    return of_above < 0 ? zeros() : rowOf(band - 1, of_above, {turns.above, turns.above});
  }
  const int row_count = bands_.rows(band), from_last = row_count - 1 - row;
  const std::size_t set = turns.own % sets();
  // A band with fewer rows would write over what it still reads of the band before. If it is the
  // last one, nobody needs its rows.
  const bool leaves_rows = row_count == kBandRows || band == 0;
  if (leaves_rows && from_last == 0) {
    return last_places_.data() + turns.own % kBoundaries * row_pixels_ + kPathMargin;
  }
  if (!leaves_rows || from_last != 1) return ringRow(set, row);
  const std::size_t cell = kinds_->cellOfRow(bands_.firstRow(band) + row);
  if (!keeps_pixels_[cell]) return ringRow(set, kSpareRing);
  return last_but_one_places_.data() + (cell * sets() + set) * row_pixels_ + kPathMargin;
}

PathRow PathRows::ringRow(std::size_t set, int row) const {
  return ring_places_.data() + (set * kBandRows + row) * row_pixels_ + kPathMargin;
}

BandPathRows PathRows::find(int band, const BandTurns& turns) const {
  BandPathRows found;
  const int first = bands_.firstRow(band);
  for (int row = -kRowsAbove; row < bands_.rows(band); ++row) {
    found.places[kRowsAbove + row] = rowOf(band, row, turns);
    if (first + row >= 0) found.kinds[kRowsAbove + row] = kinds_->row(first + row);
  }
  return found;
}

}  // namespace adaptive_grid_stereo
