#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "adaptive_grid_stereo/matching/refinement.h"
#include "adaptive_grid_stereo/matching/stereo_matcher.h"

namespace adaptive_grid_stereo {
namespace {

// Regions are made of runs; those of adjacent rows are joined by union-find.
class Regions {
 public:
  using Run = RegionBuffers::Run;

  Regions(RegionBuffers* buffers, int max_step) : b_(*buffers), max_step_(max_step) {
    b_.runs.clear();
    b_.row_begin.assign(1, 0);
  }

  void addRow(const std::int16_t* values, int width) {
    constexpr int kWord = sizeof(std::uint64_t);
    b_.edges.assign((width + kWord - 1) / kWord * kWord, 0);
    std::uint8_t* edges = b_.edges.data();
    const int max_step = max_step_;
    for (int x = 1; x < width; ++x) {
      const int value = values[x], before = values[x - 1];
      edges[x] = (std::abs(value - before) > max_step) |
                 ((value == kInvalidDisparity) != (before == kInvalidDisparity));
    }
    int begin = 0;
    for (int x = 0; x < width; x += kWord) {
      std::uint64_t word;
      std::memcpy(&word, edges + x, kWord);
      if (word == 0) continue;
      for (int edge = x; edge < x + kWord; ++edge) {
        if (edges[edge] == 0) continue;
        addRun(values, begin, edge);
        begin = edge;
      }
    }
    addRun(values, begin, width);
    b_.row_begin.push_back(static_cast<std::int32_t>(b_.runs.size()));
  }

  // Joins row y to the one above it.
  void joinRows(const std::int16_t* values_above, const std::int16_t* values, int y) {
    std::int32_t a = b_.row_begin[y - 1], b = b_.row_begin[y];
    const std::int32_t end_a = b, end_b = b_.row_begin[y + 1];
    while (a < end_a && b < end_b) {
      const Run &above = b_.runs[a], &here = b_.runs[b];
      const int begin = std::max(above.begin, here.begin), end = std::min(above.end, here.end);
      const bool above_ends_first = above.end < here.end;
      if (touch(values_above, values, begin, end)) join(a, b);
      ++(above_ends_first ? a : b);
    }
  }

  std::int32_t root(std::int32_t run) {
    while (b_.runs[run].parent != run) {
      b_.runs[run].parent = b_.runs[b_.runs[run].parent].parent;
      run = b_.runs[run].parent;
    }
    return run;
  }

 private:
  void addRun(const std::int16_t* values, int begin, int end) {
    if (values[begin] == kInvalidDisparity) return;
    const std::int32_t run = static_cast<std::int32_t>(b_.runs.size());
    b_.runs.push_back({begin, end, run, end - begin});
  }

  bool touch(const std::int16_t* above, const std::int16_t* values, int begin, int end) const {
    for (int x = begin; x < end; ++x) {
      if (std::abs(above[x] - values[x]) <= max_step_) return true;
    }
    return false;
  }

  void join(std::int32_t a, std::int32_t b) {
    a = root(a);
    b = root(b);
    if (a == b) return;
    if (b_.runs[a].size < b_.runs[b].size) std::swap(a, b);
    b_.runs[b].parent = a;
    b_.runs[a].size += b_.runs[b].size;
  }

  RegionBuffers& b_;
  const int max_step_;
};

}  // namespace

void removeSmallRegions(int max_size, int max_step, RegionBuffers* buffers, cv::Mat* disparity) {
  const int width = disparity->cols, height = disparity->rows;
  Regions regions(buffers, max_step);
  for (int y = 0; y < height; ++y) {
    const std::int16_t* values = disparity->ptr<std::int16_t>(y);
    regions.addRow(values, width);
    if (y > 0) regions.joinRows(disparity->ptr<std::int16_t>(y - 1), values, y);
  }
  for (int y = 0; y < height; ++y) {
    std::int16_t* values = disparity->ptr<std::int16_t>(y);
    for (std::int32_t run = buffers->row_begin[y]; run < buffers->row_begin[y + 1]; ++run) {
      if (buffers->runs[regions.root(run)].size > max_size) continue;
      std::fill(values + buffers->runs[run].begin, values + buffers->runs[run].end,
                kInvalidDisparity);
    }
  }
}

}  // namespace adaptive_grid_stereo
