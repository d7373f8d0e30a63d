#include "src/matching/path_rows.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

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

void PathRows::prepare(int width, const PathLayout& layout, int threads) {
  const bool moved = layout.range != layout_.range || layout.padded_range != layout_.padded_range;
  bool changed = moved || width != width_ || threads != threads_;
  width_ = width;
  threads_ = threads;
  layout_ = layout;
  row_pixels_ = static_cast<std::size_t>(width) + 2 * kPathMargin;
  // The first and the last strip are up to so many bands apart.
  sets_ = threads == 1 ? 0 : 2 * threads + 2;
  const auto reserve = [&](std::size_t pixels, AlignedBuffer<std::uint8_t>* buffer) {
    // Neighbours of the last disparity are read one byte further.
    const std::size_t bytes = pixels * layout.pixel_stride + kMaxLanes;
    const bool grew = buffer->reserve(bytes);
    if (grew || moved) std::memset(buffer->data(), 255, bytes);
    changed = changed || grew;
  };
  reserve(2 * kBoundaries * row_pixels_, &boundary_);
  reserve(static_cast<std::size_t>(sets_ + threads) * kBandRows * kRingPixels, &rings_);
  reserve(1, &zero_);
  if (!changed) return;
  for (int r = 0; r < kSweepDirections; ++r) {
    zero_.data()[r] = 0;
    std::memset(zero_.data() + kPixelHeader + r * layout.padded_range, 0, layout.range);
  }
  zero_row_.assign(row_pixels_, zero_.data());
  for (Places& places : places_) places.edges.clear();
}

void PathRows::assign(bool second_sweep, const Strips& strips) {
  Places& places = places_[second_sweep];
  if (places.edges == strips.edges()) return;
  places.edges = strips.edges();
  const int sets = std::max(1, sets_);
  // All pixels outside of the image share one place of zeros, which nobody writes to.
  places.boundary.assign(2 * kBoundaries * row_pixels_, zero_.data());
  places.ring.assign(static_cast<std::size_t>(sets) * kBandRows * row_pixels_, zero_.data());
  for (std::size_t i = kPathMargin; i < row_pixels_ - kPathMargin; ++i) {
    const int owner = ownerOf(places.edges, static_cast<int>(i) - kPathMargin);
    const bool owned = owner != kShared;
    for (std::size_t row = 0; row < 2 * kBoundaries; ++row) {
      const std::size_t place = (owned ? row % 2 : row) * row_pixels_ + i;
      places.boundary[row * row_pixels_ + i] = boundary_.data() + place * layout_.pixel_stride;
    }
    for (int set = 0; set < sets; ++set) {
      for (int row = 0; row < kBandRows; ++row) {
        const std::size_t ring =
            static_cast<std::size_t>(owned ? sets_ + owner : set) * kBandRows + row;
        places.ring[(static_cast<std::size_t>(set) * kBandRows + row) * row_pixels_ + i] =
            rings_.data() + (ring * kRingPixels + i % kRingPixels) * layout_.pixel_stride;
      }
    }
  }
}

PathRow PathRows::rowOf(const Places& places, int band, int row, int row_count) const {
  const auto boundary = [&](int of_band, int from_last) -> PathRow {
    if (of_band < 0) return zero_row_.data() + kPathMargin;
    const std::size_t slot = of_band % kBoundaries;
    return places.boundary.data() + (2 * slot + from_last) * row_pixels_ + kPathMargin;
  };
  if (row < 0) return boundary(band - 1, -1 - row);
  const int from_last = row_count - 1 - row;
  if (row_count == kBandRows && from_last < 2) return boundary(band, from_last);
  const std::size_t set = sets_ > 0 ? band % sets_ : 0;
  return places.ring.data() + (set * kBandRows + row) * row_pixels_ + kPathMargin;
}

void PathRows::find(bool second_sweep, int band, int row, int row_count, SweepRow* out) const {
  const Places& places = places_[second_sweep];
  out->current = rowOf(places, band, row, row_count);
  out->above = rowOf(places, band, row - 1, row_count);
  out->above2 = rowOf(places, band, row - 2, row_count);
}

}  // namespace adaptive_grid_stereo
