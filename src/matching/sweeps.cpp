#include "src/matching/sweeps.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "adaptive_grid_stereo/matching/census.h"

namespace adaptive_grid_stereo {
namespace {

// Pixels of path costs that a row inside a band keeps: more than the reach of two rows below it,
// 2 * kBandLag + 1, and a power of two.
constexpr int kRingPixels = 8;
static_assert(2 * kBandLag + 2 <= kRingPixels, "a ring must hold what the rows below still need");
static_assert(kBandRows >= 2, "the two rows above a band come from one band");

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
  const PathLayout layout = makeLayout(config.disparity_range);
  // Path costs beyond the range must be 255; a new layout puts them elsewhere.
  const bool moved =
      layout.range != frame_.layout.range || layout.padded_range != frame_.layout.padded_range;
  frame_.layout = layout;
  fillPenaltyTable(config, penalty_table_);

  const auto reserveCosts = [&](std::size_t pixels, AlignedBuffer<std::uint8_t>* buffer) {
    // Neighbours of the last disparity are read one byte further.
    const std::size_t bytes = pixels * layout.pixel_stride + kMaxLanes;
    if (buffer->reserve(bytes) || moved) std::memset(buffer->data(), 255, bytes);
  };
  const std::size_t volume_size = static_cast<std::size_t>(width) * height * layout.padded_range;
  volume_.reserve(volume_size);
  frame_.stream_volume = volume_size * sizeof(std::uint16_t) >= kStreamedVolume;
  const std::size_t row_pixels = static_cast<std::size_t>(width) + 2 * kPathMargin;
  reserveCosts(2 * row_pixels * (threads + 1), &boundary_rows_);
  reserveCosts(1, &zero_pixel_);
  for (int r = 0; r < kSweepDirections; ++r) {
    zero_pixel_.data()[r] = 0;
    std::memset(zero_pixel_.data() + kPixelHeader + r * layout.padded_range, 0, layout.range);
  }
  const int bands = (height + kBandRows - 1) / kBandRows;
  if (bands > progress_size_) {
    progress_.reset(new BandProgress[bands]);
    progress_size_ = bands;
  }
  penalty_stride_ = kSweepDirections * ((static_cast<std::size_t>(width) + 63) / 64 * 64);
  workers_.resize(threads);
  for (Worker& worker : workers_) {
    reserveCosts(kBandRows * kRingPixels, &worker.rings);
    worker.penalties.reserve(kBandRows * penalty_stride_);
    worker.winners.resize(static_cast<std::size_t>(kBandRows) * width);
  }
  placePathCosts(threads);
}

void Sweeps::placePathCosts(int threads) {
  const std::size_t stride = frame_.layout.pixel_stride;
  const std::size_t row_pixels = static_cast<std::size_t>(frame_.width) + 2 * kPathMargin;
  zero_places_.assign(row_pixels, zero_pixel_.data());
  boundary_places_.resize(2 * (threads + 1) * row_pixels);
  for (std::size_t i = 0; i < boundary_places_.size(); ++i) {
    boundary_places_[i] = boundary_rows_.data() + i * stride;
  }
  for (Worker& worker : workers_) {
    worker.ring_places.resize(kBandRows * row_pixels);
    for (std::size_t i = 0; i < worker.ring_places.size(); ++i) {
      const std::size_t ring = i / row_pixels, place = i % row_pixels % kRingPixels;
      worker.ring_places[i] = worker.rings.data() + (ring * kRingPixels + place) * stride;
    }
  }
}

void Sweeps::run(const SweepImages& images, const PathPlan& plan, ThreadPool* pool,
                 cv::Mat* disparity) {
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
  runSweep(images, false, pool, disparity);
  runSweep(images, true, pool, disparity);
}

void Sweeps::runSweep(const SweepImages& images, bool second, ThreadPool* pool,
                      cv::Mat* disparity) {
  const int bands = (frame_.height + kBandRows - 1) / kBandRows;
  const int threads = pool->size();
  for (int band = 0; band < bands; ++band) {
    progress_[band].column.store(-kPathMargin - 1, std::memory_order_relaxed);
  }
  pool->run([&](int thread) {
    for (int band = thread; band < bands; band += threads) {
      runBandOf(images, second, band, threads, &workers_[thread], disparity);
    }
  });
}

void Sweeps::fillPathRows(int band, int row, int row_count, int threads, Worker* worker,
                          SweepRow* out) {
  const std::size_t row_pixels = static_cast<std::size_t>(frame_.width) + 2 * kPathMargin;
  // A band leaves its last two rows to the next one. There are enough slots that none is written
  // again before its reader, which runs on the same thread as the next writer, is done.
  const auto boundary = [&](int of_band, int from_last) {
    if (of_band < 0) return zero_places_.data() + kPathMargin;
    const std::size_t slot = of_band % (threads + 1);
    return boundary_places_.data() + (2 * slot + from_last) * row_pixels + kPathMargin;
  };
  const auto rowOf = [&](int index) -> PathRow {
    if (index < 0) return boundary(band - 1, -1 - index);
    const int from_last = row_count - 1 - index;
    if (row_count == kBandRows && from_last < 2) return boundary(band, from_last);
    return worker->ring_places.data() + index * row_pixels + kPathMargin;
  };
  out->current = rowOf(row);
  out->above = rowOf(row - 1);
  out->above2 = rowOf(row - 2);
}

void Sweeps::fillPenalties(const SweepImages& images, bool second, int v, int row, Worker* worker,
                           SweepRow* out) {
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
  penaltyRow(pixels(v), previous, kinds_[second].directions(v), frame_.width, penalty_table_,
             target);
  out->penalties = target;
}

void Sweeps::runBandOf(const SweepImages& images, bool second, int band, int threads,
                       Worker* worker, cv::Mat* disparity) {
  const int width = frame_.width, height = frame_.height;
  const int first = band * kBandRows;
  const int row_count = std::min(kBandRows, height - first);
  const std::size_t census_row = censusPlanes(frame_.window) * censusStride(width);
  SweepRow rows[kBandRows];
  for (int i = 0; i < row_count; ++i) {
    const int v = first + i;
    const int y = second ? height - 1 - v : v;
    SweepRow& row = rows[i];
    row.kinds = kinds_[second].row(v);
    row.kind_ends = kinds_[second].ends(v);
    fillPenalties(images, second, v, i, worker, &row);
    fillPathRows(band, i, row_count, threads, worker, &row);
    row.left = images.left_census + y * census_row;
    row.right = images.right_census + y * census_row;
    row.volume = volume_.data() + static_cast<std::size_t>(y) * width * frame_.layout.padded_range;
    row.winners = worker->winners.data() + static_cast<std::size_t>(i) * width;
  }
  runBand(frame_, second, rows, row_count, band > 0 ? &progress_[band - 1] : nullptr,
          &progress_[band]);
  if (!second) return;
  for (int i = 0; i < row_count; ++i) {
    const int y = height - 1 - (first + i);
    int cell = 0;
    while (y >= plan_.row_edges[cell + 1]) ++cell;
    selectRow(rows[i].winners, shifts_.data() + static_cast<std::size_t>(cell) * width, width,
              config_, &worker->claims, disparity->ptr<std::int16_t>(y));
  }
}

}  // namespace adaptive_grid_stereo
