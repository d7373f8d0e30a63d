#include "src/matching/sweeps.h"

#include <algorithm>
#include <cmath>

#include "src/matching/row_parts.h"
#include "src/matching/stopwatch.h"

namespace adaptive_grid_stereo {
namespace {

// From this size on the volume does not stay in the caches from one sweep to the other.
constexpr std::size_t kStreamedVolume = std::size_t{12} << 20;  // [bytes]

// Whether to write the volume past the caches. With several threads, whatever its size: what one
// of them writes another one may read, so in a cache it would have to be fetched from the other's,
// and be taken back to be written for the next frame. Where cores share no cache that takes longer
// than memory does: more than two threads half of a small frame's time, two, which read mostly what
// they have written themselves, a few percent.
bool streamsVolume(std::size_t bytes, int threads) {
  return threads > 1 || bytes >= kStreamedVolume;
}

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
  SweepFrame frame;
  frame.width = width;
  frame.height = height;
  frame.min_disparity = config.min_disparity;
  frame.penalty_small = config.penalty_small;
  frame.window = config.census_window;
  frame.uniqueness_factor =
      config.uniqueness_ratio > 0.0
          ? static_cast<int>(std::lround(4096.0 * 100.0 / (100.0 - config.uniqueness_ratio)))
          : 0;
  frame.layout = makeLayout(config.disparity_range);
  frame.long_range = frame.layout.padded_range > kSearchBlocks * sweepLanes();
  // A pixel's disparities begin at most so far outside, and end so much farther.
  const int farthest = std::abs(config.min_disparity) + frame.layout.padded_range;
  outside_.reserve(width + 2 * static_cast<std::size_t>(farthest));
  std::fill_n(outside_.data(), width + 2 * farthest, std::uint8_t{255});
  std::fill_n(outside_.data() + farthest, width, std::uint8_t{0});
  frame.outside = outside_.data() + farthest;
  fillPenaltyTable(config, penalty_table_);
  const std::size_t volume_size =
      static_cast<std::size_t>(width) * height * frame.layout.padded_range;
  volume_.reserve(volume_size);
  frame.stream_volume = streamsVolume(volume_size * sizeof(std::uint16_t), threads);
  threads_ = threads;
  const int strips = Strips::perSweep(threads);
  bands_only_ = threads <= 2;
  kept_rows_ = threads == 1 ? kBandRows : threads == 2 ? kBandRows * Strips::kOpenBands : height;
  const int penalty_blocks = (width + kLargestLag + kPenaltyBlock - 1) / kPenaltyBlock;
  penalty_stride_ = penaltyPlace(penalty_blocks * kPenaltyBlock, 0);
  workers_.resize(static_cast<std::size_t>(kSweeps) * strips);
  for (Worker& worker : workers_) worker.penalties.reserve(kBandRows * penalty_stride_);
  for (const int sweep : {kDown, kUp}) {
    frames_[sweep] = frame;
    bands_[sweep] = Bands(height, sweep == kUp);
    path_rows_[sweep].prepare(width, frame.layout, strips);
    if (sweep != setOf(sweep)) continue;
    census_[sweep].prepare(width, kept_rows_, threads);
    winners_[sweep].reserve(3 * static_cast<std::size_t>(width) * kept_rows_);
  }
  frames_[kUp].course = {-1, width};
}

void Sweeps::run(const SweepImages& images, const PathPlan& plan, const std::atomic<bool>& stop,
                 ThreadPool* pool, cv::Mat* disparity) {
  const int width = frames_[kDown].width, height = frames_[kDown].height;
  const bool new_plan = plan_ != plan;
  if (new_plan) {
    plan_ = PathPlan();  // no plan, until all that is made from it is there
    for (const int sweep : {kDown, kUp}) kinds_[sweep].assign(plan, sweep == kUp);
    for (Worker& worker : workers_) worker.runs.forget();
    shifts_.assign(3 * static_cast<std::size_t>(width), 0);
    for (int cell = 0; cell < 9; ++cell) {
      std::uint8_t* row = shifts_.data() + static_cast<std::size_t>(cell / 3) * width;
      const int shift = plan.paths[cell] == 16 ? 0 : plan.paths[cell] == 8 ? 1 : 2;
      std::fill(row + plan.column_edges[cell % 3], row + plan.column_edges[cell % 3 + 1], shift);
    }
  }
  for (Worker& worker : workers_) worker.census_time = 0.0;
  if (!bands_only_) {
    forRowParts(height, pool, [&](int thread, RowRange rows) {
      makeCensus(images, rows.first, rows.last, kDown, thread, &workers_[thread]);
    });
  }
  strips_.assign(plan, threads_, &stop);
  for (const int sweep : {kDown, kUp}) {
    if (path_rows_[sweep].assign(bands_[sweep], strips_.edges(sweep), kinds_[sweep], new_plan)) {
      for (Worker& worker : workers_) worker.band_places.forget();
    }
  }
  plan_ = plan;
  pool->run([&](int thread) {
    if (thread >= strips_.count()) return;
    strips_.run(
        thread, [&](const Strips::Part& part) { preparePart(images, part); },
        [&](const Strips::Part& part, int first, int last) {
          workOnPart(part, first, last, disparity);
        });
  });
  if (stop || bands_only_) return;  // selected on the way
  forRowParts(height, pool, [&](int thread, RowRange rows) {
    selectRows(rows.first, rows.last, kDown, &workers_[thread].buffers, disparity);
  });
}

double Sweeps::censusTime() const {
  double sum = 0.0;
  for (const Worker& worker : workers_) sum += worker.census_time;
  return sum / threads_;
}

void Sweeps::makeCensus(const SweepImages& images, int first, int last, int set, int thread,
                        Worker* worker) {
  const Stopwatch watch;
  census_[set].make(*images.left, *images.right_mirrored, frames_[kDown].window, first, last,
                    thread);
  worker->census_time += watch.milliseconds();
}

void Sweeps::preparePart(const SweepImages& images, const Strips::Part& part) {
  Worker& worker = workers_[part.buffers];
  const Bands& bands = bands_[part.sweep];
  worker.row_count = bands.rows(part.band);
  if (bands_only_ && !part.second_pass) {
    const int y = bands.imageRow(part.band);
    makeCensus(images, y, y + worker.row_count, part.sweep, 0, &worker);
  }
  PathRows& path_rows = path_rows_[part.sweep];
  worker.places = worker.band_places.find(path_rows.find(part.band, part.turns), part.begin,
                                          part.end, frames_[part.sweep].width, path_rows.zero());
  for (int i = 0; i < worker.row_count; ++i) {
    worker.rows[i] = makeRow(part, i);
    if (part.second_pass) {
      fetchVolume(worker.rows[i], frames_[part.sweep], part.begin - kBandLag * i);
    }
    fillPenalties(images, part, i, &worker);
  }
}

void Sweeps::workOnPart(const Strips::Part& part, int first, int last, cv::Mat* disparity) {
  Worker& worker = workers_[part.buffers];
  const auto pass = part.second_pass ? runSecondPass : runFirstPass;
  const SweepFrame& frame = frames_[part.sweep];
  const auto& runs = worker.runs.find(frame, worker.rows, worker.row_count, first, last);
  pass(frame, worker.rows, worker.row_count, worker.places, runs.data(), runs.size());
  // A row is selected as a whole: at once, while it is in the cache, if a thread has whole rows.
  if (!bands_only_ || !part.second_pass || last < strips_.edges(part.sweep).back()) return;
  const int y = bands_[part.sweep].imageRow(part.band);
  selectRows(y, y + worker.row_count, winnersSetOf(part.sweep), &worker.buffers, disparity);
}

void Sweeps::fillPenalties(const SweepImages& images, const Strips::Part& part, int index,
                           Worker* worker) {
  const bool upward = part.sweep == kUp;
  const SweepFrame& frame = frames_[part.sweep];
  const int v = bands_[part.sweep].firstRow(part.band) + index;
  // The upward sweep reads the image turned by 180 degrees: mirrored, from the last row up.
  const PaddedImage& image = upward ? *images.left_mirrored : *images.left;
  const int lag = kBandLag * index;
  const auto pixelsByStep = [&](int of_v) {
    return image.row(upward ? frame.height - 1 - of_v : of_v) - lag;
  };
  constexpr int kStep[kSweepDirections][2] = {{1, 0}, {0, 1},  {1, 1}, {-1, 1},
                                              {2, 1}, {-2, 1}, {1, 2}, {-1, 2}};
  const std::uint8_t* previous[kSweepDirections];
  for (int r = 0; r < kSweepDirections; ++r) {
    previous[r] = pixelsByStep(v - kStep[r][1]) - kStep[r][0];
  }
  std::uint8_t* target = worker->penalties.data() + index * penalty_stride_;
  const int begin = part.begin & ~(kPenaltyBlock - 1);
  const int end = std::min(frame.width + lag, part.end);
  penaltyRow(pixelsByStep(v), previous, kinds_[part.sweep].directions(v), begin, end,
             penalty_table_, target);
  worker->rows[index].penalties = target;
}

void Sweeps::fetchVolume(const SweepRow& row, const SweepFrame& frame, int u) const {
  constexpr int kPixels = 4, kLine = 64 / sizeof(std::uint16_t);
  const int padded = frame.layout.padded_range;
  const Course& course = frame.course;
  const std::ptrdiff_t x = course.column(std::max(0, u));
  const std::uint16_t* volume = row.volume + std::min(x, x + course.along(kPixels - 1)) * padded;
  for (int k = 0; k < kPixels * padded / kLine; ++k) __builtin_prefetch(volume + k * kLine);
}

WinnerRow Sweeps::winnersOf(int set, int y) {
  const std::size_t width = frames_[kDown].width;
  std::uint32_t* found = winners_[set].data() + y % kept_rows_ * 3 * width;
  return {found, found + width, found + 2 * width};
}

SweepRow Sweeps::makeRow(const Strips::Part& part, int index) {
  const int sweep = part.sweep, band = part.band;
  const SweepFrame& frame = frames_[sweep];
  const int v = bands_[sweep].firstRow(band) + index;
  const int y = sweep == kUp ? frame.height - 1 - v : v;
  const std::size_t row_volume = static_cast<std::size_t>(frame.width) * frame.layout.padded_range;
  SweepRow row{};
  row.kinds = kinds_[sweep].row(v);
  row.kind_ends = kinds_[sweep].ends(v);
  row.left = census_[setOf(sweep)].left(y);
  row.right = census_[setOf(sweep)].right(y);
  row.volume = volume_.data() + y * row_volume;
  row.winners = winnersOf(winnersSetOf(sweep), y);
  return row;
}

void Sweeps::selectRows(int first, int last, int set, RowBuffers* buffers, cv::Mat* disparity) {
  const int width = frames_[kDown].width;
  int cell = 0;
  for (int y = first; y < last; ++y) {
    while (y >= plan_.row_edges[cell + 1]) ++cell;
    selectRow(winnersOf(set, y), shifts_.data() + static_cast<std::size_t>(cell) * width, width,
              config_, buffers, disparity->ptr<std::int16_t>(y));
  }
}

}  // namespace adaptive_grid_stereo
