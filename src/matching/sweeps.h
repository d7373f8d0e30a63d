#ifndef ADAPTIVE_GRID_STEREO_SRC_MATCHING_SWEEPS_H
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_SWEEPS_H

#include <atomic>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "adaptive_grid_stereo/matching/padded_image.h"
#include "adaptive_grid_stereo/path_plan.h"
#include "src/matching/aligned_buffer.h"
#include "src/matching/census_rows.h"
#include "src/matching/path_rows.h"
#include "src/matching/pixel_kinds.h"
#include "src/matching/row_selection.h"
#include "src/matching/strips.h"
#include "src/matching/sweep.h"
#include "src/matching/thread_pool.h"

namespace adaptive_grid_stereo {

/// What the sweeps read of a frame.
struct SweepImages {
  const PaddedImage* left = nullptr;
  const PaddedImage* left_mirrored = nullptr;
  const PaddedImage* right_mirrored = nullptr;
};

/// Census transform and the two sweeps over an image, band by band; the threads share each band by
/// strips of columns. Owns the volume between the sweeps.
class Sweeps {
 public:
  /// Makes buffers for the size and range where they are too small.
  void prepare(int width, int height, const MatcherConfig& config, int threads);

  /// disparity: CV_16SC1 of the image's size, filled with the disparities before refinement, unless
  /// `stop` becomes true: then it is left unfinished.
  void run(const SweepImages& images, const PathPlan& plan, const std::atomic<bool>& stop,
           ThreadPool* pool, cv::Mat* disparity);

  /// What the census transform took of the last run() [ms].
  double censusTime() const { return census_time_; }

 private:
  struct Worker {
    AlignedBuffer<std::uint8_t> penalties;  // [row of the band][penaltyPlace()]
    RowBuffers buffers;
    SweepRow rows[kBandRows];  // of the band
    int row_count = 0;
  };

  void runSweep(const SweepImages& images, bool second, const std::atomic<bool>& stop,
                ThreadPool* pool, cv::Mat* disparity);
  void makeCensus(const SweepImages& images, int first, int last, int thread);
  void makeCensusOfAll(const SweepImages& images, ThreadPool* pool);
  void selectRows(int first, int last, RowBuffers* buffers, cv::Mat* disparity);
  SweepRow makeRow(bool second, int band, int index, int row_count);
  void fillPenalties(const SweepImages& images, bool second, int v, int row, int first_step,
                     int end_step, Worker* worker, SweepRow* out);
  // Fetches what the second sweep reads of the volume first, from pixel u on.
  void fetchVolume(const SweepRow& row, int u) const;
  Winner* winnersOf(int y);

  MatcherConfig config_;
  SweepFrame frame_;
  std::uint8_t penalty_table_[256] = {};
  PixelKinds kinds_[2];
  std::vector<std::uint8_t> shifts_;  // [row cell][x]
  PathPlan plan_;
  AlignedBuffer<std::uint16_t> volume_;
  // Rows whose census strings and winners are kept: all, or with one thread those of a band, which
  // are made and used up while they are in the caches.
  int kept_rows_ = 1;
  CensusRows census_;
  double census_time_ = 0.0;
  AlignedBuffer<Winner> winners_;  // [y % kept_rows_][x]
  PathRows path_rows_;
  Strips strips_[2];
  std::vector<Worker> workers_;  // one per strip
  std::size_t penalty_stride_ = 0;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_SWEEPS_H
