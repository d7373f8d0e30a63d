#include <algorithm>
#include <cstdlib>

#include "adaptive_grid_stereo/matching/refinement.h"
#include "adaptive_grid_stereo/matching/stereo_matcher.h"

namespace adaptive_grid_stereo {
namespace {

// Regions are made of runs: neighbours in a row whose values differ by little enough. Runs of
// adjacent rows are joined by union-find, where the root has the region's size.
class Regions {
 public:
  Regions(RegionBuffers* buffers, int max_step) : b_(*buffers), max_step_(max_step) {
    b_.parent.clear();
    b_.size.clear();
    b_.run_begin.clear();
    b_.row_begin.clear();
  }

  void addRow(const std::int16_t* values, int width, std::int32_t* run_of_pixel) {
    b_.row_begin.push_back(static_cast<std::int32_t>(b_.run_begin.size()));
    std::int32_t run = -1;
    int begin = 0;
    int previous = kInvalidDisparity;
    for (int x = 0; x < width; ++x) {
      const int value = values[x];
      if (value == kInvalidDisparity) {
        closeRun(&run, begin, x);
      } else if (run < 0 || std::abs(value - previous) > max_step_) {
        closeRun(&run, begin, x);
        run = openRun(x);
        begin = x;
      }
      run_of_pixel[x] = run;
      previous = value;
    }
    closeRun(&run, begin, width);
  }

  void joinRows(const std::int16_t* above, const std::int32_t* runs_above,
                const std::int16_t* values, const std::int32_t* runs, int width) {
    std::int32_t last_above = -1, last = -1;
    for (int x = 0; x < width; ++x) {
      const std::int32_t a = runs_above[x], b = runs[x];
      if (a < 0 || b < 0 || (a == last_above && b == last)) continue;
      if (std::abs(above[x] - values[x]) > max_step_) continue;
      join(a, b);
      last_above = a;
      last = b;
    }
  }

  std::int32_t root(std::int32_t run) {
    while (b_.parent[run] != run) {
      b_.parent[run] = b_.parent[b_.parent[run]];
      run = b_.parent[run];
    }
    return run;
  }

 private:
  std::int32_t openRun(int x) {
    const std::int32_t run = static_cast<std::int32_t>(b_.parent.size());
    b_.parent.push_back(run);
    b_.size.push_back(0);
    b_.run_begin.push_back(x);
    return run;
  }

  void closeRun(std::int32_t* run, int begin, int end) {
    if (*run >= 0) b_.size[*run] = end - begin;
    *run = -1;
  }

  void join(std::int32_t a, std::int32_t b) {
    a = root(a);
    b = root(b);
    if (a == b) return;
    if (b_.size[a] < b_.size[b]) std::swap(a, b);
    b_.parent[b] = a;
    b_.size[a] += b_.size[b];
  }

  RegionBuffers& b_;
  const int max_step_;
};

}  // namespace

void removeSmallRegions(int max_size, int max_step, RegionBuffers* buffers, cv::Mat* disparity) {
  const int width = disparity->cols, height = disparity->rows;
  buffers->run_of_pixel.resize(2 * static_cast<std::size_t>(width));
  Regions regions(buffers, max_step);
  for (int y = 0; y < height; ++y) {
    std::int32_t* runs = buffers->run_of_pixel.data() + (y % 2) * static_cast<std::size_t>(width);
    const std::int32_t* runs_above =
        buffers->run_of_pixel.data() + ((y + 1) % 2) * static_cast<std::size_t>(width);
    const std::int16_t* values = disparity->ptr<std::int16_t>(y);
    regions.addRow(values, width, runs);
    if (y > 0) {
      regions.joinRows(disparity->ptr<std::int16_t>(y - 1), runs_above, values, runs, width);
    }
  }
  buffers->row_begin.push_back(static_cast<std::int32_t>(buffers->run_begin.size()));
  for (int y = 0; y < height; ++y) {
    std::int16_t* values = disparity->ptr<std::int16_t>(y);
    for (std::int32_t run = buffers->row_begin[y]; run < buffers->row_begin[y + 1]; ++run) {
      if (buffers->size[regions.root(run)] > max_size) continue;
      const int end = run + 1 < buffers->row_begin[y + 1] ? buffers->run_begin[run + 1] : width;
      // Between this run and the next there are only pixels that are invalid already.
      std::fill(values + buffers->run_begin[run], values + end, kInvalidDisparity);
    }
  }
}

}  // namespace adaptive_grid_stereo
