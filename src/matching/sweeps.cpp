#include "src/matching/sweeps.h"

#include <algorithm>
#include <cmath>

#include "src/matching/stopwatch.h"

namespace adaptive_grid_stereo {
namespace {

// From this size on [bytes] the volume does not stay in the caches from one sweep to the other.
constexpr std::size_t kStreamedVolume = std::size_t{12} << 20;

PathLayout makeLayout(int range) {
  PathLayout layout;
  const int lanes = std::max(sweepLanes(), 16);
  layout.range = range;
  layout.padded_range = (range + lanes - 1) / lanes * lanes;
  layout.pixel_stride =
      (kPixelHeader + kSweepDirections * static_cast<std::size_t>(layout.padded_range) + 63) / 64 *
      64;
  return layout;
}

void fillPenaltyTable(const MatcherConfig& config, std::uint8_t* table) {
  for (int step = 0; step < 256; ++step) {
    const int divided = config.penalty_large / (config.adaptive_penalty ? std::max(1, step) : 1);
    const int smallest = config.adaptive_penalty ? config.penalty_large_min : 0;
    table[step] = static_cast<std::uint8_t>(std::clamp(divided, smallest, kLargestPenalty));
  }
}

}  // namespace

void Sweeps::prepare(int width, int height, const MatcherConfig& config, int threads) {
  config_ = config;
  frame_.width = width;
  frame_.height = height;
  frame_.min_disparity = config.min_disparity;
  frame_.penalty_small = config.penalty_small;
  frame_.window = config.census_window;
  frame_.uniqueness_factor =
      config.uniqueness_ratio > 0.0
          ? static_cast<int>(std::lround(4096.0 * 100.0 / (100.0 - config.uniqueness_ratio)))
          : 0;
  frame_.layout = makeLayout(config.disparity_range);
  fillPenaltyTable(config, penalty_table_);
  const std::size_t volume_size =
      static_cast<std::size_t>(width) * height * frame_.layout.padded_range;
  volume_.reserve(volume_size);
  frame_.stream_volume = volume_size * sizeof(std::uint16_t) >= kStreamedVolume;
  path_rows_.prepare(width, frame_.layout, threads);
  penalty_stride_ = kSweepDirections * ((static_cast<std::size_t>(width) + 63) / 64 * 64);
  workers_.resize(threads);
  for (Worker& worker : workers_) worker.penalties.reserve(kBandRows * penalty_stride_);
  kept_rows_ = threads == 1 ? kBandRows : height;
  census_.prepare(width, kept_rows_, threads);
  winners_.reserve(static_cast<std::size_t>(width) * kept_rows_);
}

void Sweeps::run(const SweepImages& images, const PathPlan& plan, const std::atomic<bool>& stop,
                 ThreadPool* pool, cv::Mat* disparity) {
  if (plan_ != plan) {
    plan_ = plan;
    for (const bool second : {false, true}) kinds_[second].assign(plan, second);
    shifts_.assign(3 * static_cast<std::size_t>(frame_.width), 0);
    for (int cell = 0; cell < 9; ++cell) {
      std::uint8_t* row = shifts_.data() + static_cast<std::size_t>(cell / 3) * frame_.width;
      const int shift = plan.paths[cell] == 16 ? 0 : plan.paths[cell] == 8 ? 1 : 2;
      std::fill(row + plan.column_edges[cell % 3], row + plan.column_edges[cell % 3 + 1], shift);
    }
  }
  census_time_ = 0.0;
  if (pool->size() > 1) makeCensusOfAll(images, pool);
  for (const bool second : {false, true}) runSweep(images, second, stop, pool, disparity);
  if (stop || pool->size() == 1) return;  // selected on the way
  pool->run([&](int thread) {
    const int height = frame_.height, threads = pool->size();
    selectRows(height * thread / threads, height * (thread + 1) / threads,
               &workers_[thread].buffers, disparity);
  });
}

void Sweeps::makeCensus(const SweepImages& images, int first, int last, int thread) {
  census_.make(*images.left, *images.right_mirrored, frame_.window, first, last, thread);
}

void Sweeps::makeCensusOfAll(const SweepImages& images, ThreadPool* pool) {
  const Stopwatch watch;
  pool->run([&](int thread) {
    const int height = frame_.height, threads = pool->size();
    makeCensus(images, height * thread / threads, height * (thread + 1) / threads, thread);
  });
  census_time_ = watch.milliseconds();
}

void Sweeps::runSweep(const SweepImages& images, bool second, const std::atomic<bool>& stop,
                      ThreadPool* pool, cv::Mat* disparity) {
  Strips& strips = strips_[second];
  strips.assign(second ? turned(plan_) : plan_, pool->size(), &stop);
  path_rows_.assign(second, strips);
  const auto prepare = [&](int strip, int band) {
    Worker& worker = workers_[strip];
    worker.row_count = std::min(kBandRows, frame_.height - band * kBandRows);
    if (!second && pool->size() == 1) {
      const Stopwatch watch;
      makeCensus(images, band * kBandRows, band * kBandRows + worker.row_count, 0);
      census_time_ += watch.milliseconds();
    }
    for (int i = 0; i < worker.row_count; ++i) {
      worker.rows[i] = makeRow(second, band, i, worker.row_count);
      if (second) fetchVolume(worker.rows[i], strips.edge(strip) - kBandLag * i);
      fillPenalties(images, second, band * kBandRows + i, i, strips.edge(strip),
                    strips.edge(strip + 1), &worker, &worker.rows[i]);
    }
  };
  const auto work = [&](int strip, int band, int first, int last) {
    Worker& worker = workers_[strip];
    (second ? runSecondSweep : runFirstSweep)(frame_, worker.rows, worker.row_count, first, last);
    // A row is selected as a whole: at once, while it is in the cache, if there is but one thread.
    if (second && pool->size() == 1) {
      const int end = frame_.height - band * kBandRows;
      selectRows(end - worker.row_count, end, &worker.buffers, disparity);
    }
  };
  pool->run([&](int thread) {
    if (thread < strips.count()) strips.run(thread, prepare, work);
  });
}

void Sweeps::fillPenalties(const SweepImages& images, bool second, int v, int row, int first_step,
                           int end_step, Worker* worker, SweepRow* out) {
  // The second sweep reads the image turned by 180 degrees: mirrored, from the last row up.
  const PaddedImage& image = second ? *images.left_mirrored : *images.left;
  const auto pixels = [&](int of_v) { return image.row(second ? frame_.height - 1 - of_v : of_v); };
  constexpr int kStep[kSweepDirections][2] = {{1, 0}, {0, 1},  {1, 1}, {-1, 1},
                                              {2, 1}, {-2, 1}, {1, 2}, {-1, 2}};
  const std::uint8_t* previous[kSweepDirections];
  for (int r = 0; r < kSweepDirections; ++r) {
    previous[r] = pixels(v - kStep[r][1]) - kStep[r][0];
  }
  std::uint8_t* target = worker->penalties.data() + row * penalty_stride_;
  const int begin = std::max(0, first_step - kBandLag * row) & ~63;
  const int end = std::min(frame_.width, end_step - kBandLag * row);
  penaltyRow(pixels(v), previous, kinds_[second].directions(v), begin, end, penalty_table_, target);
  out->penalties = target;
}

void Sweeps::fetchVolume(const SweepRow& row, int u) const {
  constexpr int kPixels = 4, kLine = 64 / sizeof(std::uint16_t);
  const int padded = frame_.layout.padded_range, end = frame_.width - std::max(0, u);
  const std::uint16_t* volume = row.volume + static_cast<std::size_t>(end) * padded;
  for (int k = 1; k <= kPixels * padded / kLine; ++k) __builtin_prefetch(volume - k * kLine);
}

Winner* Sweeps::winnersOf(int y) {
  return winners_.data() + static_cast<std::size_t>(y % kept_rows_) * frame_.width;
}

SweepRow Sweeps::makeRow(bool second, int band, int index, int row_count) {
  const int width = frame_.width;
  const int v = band * kBandRows + index;
  const int y = second ? frame_.height - 1 - v : v;
  SweepRow row{};
  row.kinds = kinds_[second].row(v);
  row.kind_ends = kinds_[second].ends(v);
  path_rows_.find(second, band, index, row_count, &row);
  row.left = census_.left(y);
  row.right = census_.right(y);
  row.volume = volume_.data() + static_cast<std::size_t>(y) * width * frame_.layout.padded_range;
  row.winners = winnersOf(y);
  return row;
}

void Sweeps::selectRows(int first, int last, RowBuffers* buffers, cv::Mat* disparity) {
  int cell = 0;
  for (int y = first; y < last; ++y) {
    while (y >= plan_.row_edges[cell + 1]) ++cell;
    selectRow(winnersOf(y), shifts_.data() + static_cast<std::size_t>(cell) * frame_.width,
              frame_.width, config_, buffers, disparity->ptr<std::int16_t>(y));
  }
}

}  // namespace adaptive_grid_stereo
