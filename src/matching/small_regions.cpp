// Regions are made of runs; those of adjacent rows are joined by union-find.
#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "adaptive_grid_stereo/matching/refinement.h"
#include "adaptive_grid_stereo/matching/stereo_matcher.h"

// A plain loop, which the compiler turns into each target's vectors.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/matching/small_regions.cpp"
#include "src/matching/simd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace adaptive_grid_stereo {
namespace HWY_NAMESPACE {

// Sets edges[x] to 1 where pixels x - 1 and x do not belong together, else to 0.
HWY_ATTR void MarkEdges(const std::int16_t* values, int width, int max_step,
                        std::uint8_t* __restrict edges) {
  // Modulo 65536: differences and largest steps of disparities stay well below its half.
  const std::uint16_t most = static_cast<std::uint16_t>(max_step);
  const std::uint16_t twice = static_cast<std::uint16_t>(2 * max_step);
  edges[0] = 0;
  for (int x = 1; x < width; ++x) {
    const std::int16_t value = values[x], before = values[x - 1];
    const std::uint16_t shifted = static_cast<std::uint16_t>(value - before + most);
    edges[x] = (shifted > twice) | ((value == kInvalidDisparity) != (before == kInvalidDisparity));
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace adaptive_grid_stereo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace adaptive_grid_stereo {
HWY_EXPORT(MarkEdges);

namespace {

template <class Runs>
std::int32_t rootOf(const Runs& runs, std::int32_t run) {
  while (runs[run].parent != run) run = runs[run].parent;
  return run;
}

template <class Runs>
std::int32_t shortenedRoot(Runs* runs, std::int32_t run) {
  while ((*runs)[run].parent != run) {
    (*runs)[run].parent = (*runs)[(*runs)[run].parent].parent;
    run = (*runs)[run].parent;
  }
  return run;
}

template <class Runs>
void unite(Runs* runs, std::int32_t a, std::int32_t b) {
  a = shortenedRoot(runs, a);
  b = shortenedRoot(runs, b);
  if (a == b) return;
  if ((*runs)[a].size < (*runs)[b].size) std::swap(a, b);
  (*runs)[b].parent = a;
  (*runs)[a].size += (*runs)[b].size;
}

constexpr int kWordPixels = 64;

// 64 bytes of 0 or 1 as bits, the first one lowest (on little-endian machines).
std::uint64_t bitsOf(const std::uint8_t* bytes) {
  std::uint64_t bits = 0;
  for (int i = 0; i < 8; ++i) {
    std::uint64_t eight;
    std::memcpy(&eight, bytes + 8 * i, sizeof(eight));
    // The product's highest byte gathers the bytes' lowest bits.
    bits |= eight * 0x0102040810204080u >> 56 << 8 * i;
  }
  return bits;
}

// Whether any of the pixels one above the other belong together.
bool touch(const std::int16_t* above, const std::int16_t* here, int count, int max_step) {
  for (int x = 0; x < count; ++x) {
    if (std::abs(above[x] - here[x]) <= max_step) return true;
  }
  return false;
}

}  // namespace

void SmallRegions::start(const cv::Mat& disparity, int max_step, int parts) {
  disparity_ = disparity;
  max_step_ = max_step;
  parts_ = parts;
  part_.resize(parts);
}

void SmallRegions::find(int index) {
  Part& part = part_[index];
  part.runs.clear();
  part.row_begin.assign(1, 0);
  const int first = firstRow(index), last = firstRow(index + 1);
  for (int y = first; y < last; ++y) {
    addRow(y, &part);
    const std::int32_t end = static_cast<std::int32_t>(part.runs.size());
    if (y > first) {
      const std::size_t row = static_cast<std::size_t>(y) - first;
      joinRows(y, &part.runs, part.row_begin[row - 1], part.row_begin[row], end);
    }
    part.row_begin.push_back(end);
  }
}

void SmallRegions::addRow(int y, Part* part) const {
  const std::int16_t* values = disparity_.ptr<std::int16_t>(y);
  const int width = disparity_.cols;
  part->edges.resize(width / kWordPixels * kWordPixels + kWordPixels);
  std::uint8_t* edges = part->edges.data();
  HWY_DYNAMIC_DISPATCH(MarkEdges)(values, width, max_step_, edges);
  edges[width] = 1;  // the end of the row's last run
  std::fill(edges + width + 1, edges + part->edges.size(), std::uint8_t{0});
  // Where runs end nobody can foretell, hence as few branches as possible.
  part->ends.resize(width + 1);
  std::int32_t* last = part->ends.data();
  for (int x = 0; x <= width; x += kWordPixels) {
    for (std::uint64_t bits = bitsOf(edges + x); bits != 0; bits &= bits - 1) {
      *last++ = x + __builtin_ctzll(bits);
    }
  }
  std::vector<Run>& runs = part->runs;
  std::size_t count = runs.size();
  runs.resize(count + (last - part->ends.data()));
  std::int32_t begin = 0;
  for (const std::int32_t* end = part->ends.data(); end < last; begin = *end++) {
    runs[count] = {begin, *end, static_cast<std::int32_t>(count), *end - begin};
    count += values[begin] != kInvalidDisparity;
  }
  runs.resize(count);
}

// Joins row y, whose runs are here .. end - 1, to the row before, whose runs are above .. here - 1.
void SmallRegions::joinRows(int y, std::vector<Run>* runs, std::int32_t above, std::int32_t here,
                            std::int32_t end) const {
  const std::int16_t* values_above = disparity_.ptr<std::int16_t>(y - 1);
  const std::int16_t* values = disparity_.ptr<std::int16_t>(y);
  const std::int32_t above_end = here;
  while (above < above_end && here < end) {
    const Run &a = (*runs)[above], &b = (*runs)[here];
    const int first = std::max(a.begin, b.begin), last = std::min(a.end, b.end);
    const bool above_ends_first = a.end < b.end;
    if (touch(values_above + first, values + first, last - first, max_step_)) {
      unite(runs, above, here);
    }
    ++(above_ends_first ? above : here);
  }
}

void SmallRegions::join() {
  runs_.clear();
  row_begin_.clear();
  for (Part& part : part_) {
    const std::int32_t offset = static_cast<std::int32_t>(runs_.size());
    for (std::size_t row = 0; row + 1 < part.row_begin.size(); ++row) {
      row_begin_.push_back(part.row_begin[row] + offset);
    }
    if (offset == 0) {
      std::swap(runs_, part.runs);
      continue;
    }
    for (const Run& run : part.runs) {
      runs_.push_back({run.begin, run.end, run.parent + offset, run.size});
    }
  }
  row_begin_.push_back(static_cast<std::int32_t>(runs_.size()));
  for (int part = 1; part < parts_; ++part) {
    const int y = firstRow(part);
    if (y == 0 || y == firstRow(part + 1)) continue;
    joinRows(y, &runs_, row_begin_[y - 1], row_begin_[y], row_begin_[y + 1]);
  }
}

void SmallRegions::erase(int part, int max_size, cv::Mat* disparity) const {
  for (int y = firstRow(part); y < firstRow(part + 1); ++y) {
    std::int16_t* values = disparity->ptr<std::int16_t>(y);
    for (std::int32_t run = row_begin_[y]; run < row_begin_[y + 1]; ++run) {
      if (runs_[rootOf(runs_, run)].size > max_size) continue;
      std::fill(values + runs_[run].begin, values + runs_[run].end, kInvalidDisparity);
    }
  }
}

void removeSmallRegions(int max_size, int max_step, SmallRegions* regions, cv::Mat* disparity) {
  regions->start(*disparity, max_step, 1);
  regions->find(0);
  regions->join();
  regions->erase(0, max_size, disparity);
}

}  // namespace adaptive_grid_stereo
#endif  // HWY_ONCE
