// Regions are made of runs; those of adjacent rows are joined by union-find.
#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "adaptive_grid_stereo/matching/refinement.h"
#include "adaptive_grid_stereo/matching/stereo_matcher.h"
#include "src/matching/row_parts.h"

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

template <class Node>
std::int32_t rootOf(const Node* nodes, std::int32_t node) {
  while (nodes[node].parent != node) node = nodes[node].parent;
  return node;
}

template <class Node>
std::int32_t shortenedRoot(Node* nodes, std::int32_t node) {
  while (nodes[node].parent != node) {
    nodes[node].parent = nodes[nodes[node].parent].parent;
    node = nodes[node].parent;
  }
  return node;
}

template <class Node>
void unite(Node* nodes, std::int32_t a, std::int32_t b) {
  a = shortenedRoot(nodes, a);
  b = shortenedRoot(nodes, b);
  if (a == b) return;
  if (nodes[a].size < nodes[b].size) std::swap(a, b);
  nodes[b].parent = a;
  nodes[a].size += nodes[b].size;
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
  parts_.resize(parts);
}

void SmallRegions::find(int index) {
  Part& part = parts_[index];
  const RowRange rows = rowsOfPart(disparity_.rows, index, static_cast<int>(parts_.size()));
  part.first_row = rows.first;
  part.end_row = rows.last;
  part.runs.clear();
  part.row_begin.assign(1, 0);
  for (int y = part.first_row; y < part.end_row; ++y) {
    addRow(y, &part);
    part.row_begin.push_back(static_cast<std::int32_t>(part.runs.size()));
    if (y == part.first_row) continue;
    Run* runs = part.runs.data();
    findTouching(y, part, part,
                 [=](std::int32_t above, std::int32_t here) { unite(runs, above, here); });
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

// Calls join(run, run) for runs of row y - 1, which is in part `above`, and of row y, in part
// `here`, that belong together.
template <class Join>
void SmallRegions::findTouching(int y, const Part& above, const Part& here,
                                const Join& join) const {
  const std::int16_t* values_above = disparity_.ptr<std::int16_t>(y - 1);
  const std::int16_t* values = disparity_.ptr<std::int16_t>(y);
  const Run *runs_above = above.runs.data(), *runs = here.runs.data();
  const int row_above = y - 1 - above.first_row, row = y - here.first_row;
  std::int32_t a = above.row_begin[row_above], b = here.row_begin[row];
  const std::int32_t a_end = above.row_begin[row_above + 1], b_end = here.row_begin[row + 1];
  while (a < a_end && b < b_end) {
    const Run run_above = runs_above[a], run = runs[b];
    const int first = std::max(run_above.begin, run.begin);
    const int last = std::min(run_above.end, run.end);
    const bool above_ends_first = run_above.end < run.end;
    if (touch(values_above + first, values + first, last - first, max_step_)) join(a, b);
    ++(above_ends_first ? a : b);
  }
}

// Where the region of a part's run is among the joined ones.
std::int32_t SmallRegions::joinedPlace(Part* part, std::int32_t run) {
  Run& root = part->runs[shortenedRoot(part->runs.data(), run)];
  if (root.size >= 0) {
    const std::int32_t place = static_cast<std::int32_t>(joined_.size());
    joined_.push_back({place, root.size});
    root.size = ~place;
  }
  return ~root.size;
}

void SmallRegions::join() {
  joined_.clear();
  Part* above = nullptr;
  for (Part& here : parts_) {
    if (here.first_row == here.end_row) continue;
    if (above != nullptr) {
      findTouching(here.first_row, *above, here, [&](std::int32_t a, std::int32_t b) {
        const std::int32_t place_above = joinedPlace(above, a), place = joinedPlace(&here, b);
        unite(joined_.data(), place_above, place);
      });
    }
    above = &here;
  }
}

void SmallRegions::erase(int index, int max_size, cv::Mat* disparity) const {
  const Part& part = parts_[index];
  const Run* runs = part.runs.data();
  for (int y = part.first_row; y < part.end_row; ++y) {
    std::int16_t* values = disparity->ptr<std::int16_t>(y);
    const int row = y - part.first_row;
    for (std::int32_t run = part.row_begin[row]; run < part.row_begin[row + 1]; ++run) {
      std::int32_t size = runs[rootOf(runs, run)].size;
      if (size < 0) size = joined_[rootOf(joined_.data(), ~size)].size;
      if (size > max_size) continue;
      std::fill(values + runs[run].begin, values + runs[run].end, kInvalidDisparity);
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
