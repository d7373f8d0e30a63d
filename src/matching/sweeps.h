#ifndef ADAPTIVE_GRID_STEREO_SRC_MATCHING_SWEEPS_H
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_SWEEPS_H

#include <atomic>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "adaptive_grid_stereo/matching/padded_image.h"
#include "adaptive_grid_stereo/path_plan.h"
#include "src/matching/aligned_buffer.h"
#include "src/matching/band_places.h"
#include "src/matching/band_runs.h"
#include "src/matching/bands.h"
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

/// Census transform and the two sweeps over an image, band by band; the threads share them as
/// Strips tells. Owns the volume that the sweeps leave to each other.
class Sweeps {
 public:
  /// Makes buffers for the size and range where they are too small.
  void prepare(int width, int height, const MatcherConfig& config, int threads);

  /// disparity: CV_16SC1 of the image's size, filled with the disparities before refinement, unless
  /// `stop` becomes true: then it is left unfinished.
  void run(const SweepImages& images, const PathPlan& plan, const std::atomic<bool>& stop,
           ThreadPool* pool, cv::Mat* disparity);

  /// What the census transform took of the last run() [ms], the mean of the threads.
  double censusTime() const;

 private:
  // What the thread that works on a strip (Strips::Part::buffers) needs, on cache lines of its own.
  struct alignas(64) Worker {
    AlignedBuffer<std::uint8_t> penalties;  // [row of the band][penaltyPlace()]
    RowBuffers buffers;
    SweepRow rows[kBandRows];  // of the band
    int row_count = 0;
    PathPlaces places;  // of the band
    BandPlaces band_places;
    BandRuns runs;
    double census_time = 0.0;  // [ms]
  };

  void makeCensus(const SweepImages& images, int first, int last, int set, int thread,
                  Worker* worker);
  void preparePart(const SweepImages& images, const Strips::Part& part);
  void workOnPart(const Strips::Part& part, int first, int last, cv::Mat* disparity);
  void selectRows(int first, int last, int set, RowBuffers* buffers, cv::Mat* disparity);
  SweepRow makeRow(const Strips::Part& part, int index);
  void fillPenalties(const SweepImages& images, const Strips::Part& part, int index,
                     Worker* worker);
  // Fetches what a row's second pass reads of the volume first, from pixel u on.
  void fetchVolume(const SweepRow& row, const SweepFrame& frame, int u) const;
  WinnerRow winnersOf(int set, int y);
  // Which census strings a sweep's first pass uses, and which winners its second pass: those of one
  // thread, which changes over in between, or those of both sweeps.
  int setOf(int sweep) const { return bands_only_ ? sweep : 0; }
  int winnersSetOf(int sweep) const { return setOf(1 - sweep); }

  MatcherConfig config_;
  SweepFrame frames_[kSweeps];
  AlignedBuffer<std::uint8_t> outside_;  // SweepFrame::outside
  Bands bands_[kSweeps];
  std::uint8_t penalty_table_[256] = {};
  PixelKinds kinds_[kSweeps];
  std::vector<std::uint8_t> shifts_;  // [row cell][x]
  PathPlan plan_;
  AlignedBuffer<std::uint16_t> volume_;
  int threads_ = 1;
  // Whether threads have whole rows (until they help each other in the end), and so make and use up
  // a band's census strings and winners while they are in the caches. Otherwise those of all rows
  // are kept.
  bool bands_only_ = true;
  int kept_rows_ = kBandRows;
  CensusRows census_[kSweeps];
  AlignedBuffer<std::uint32_t> winners_[kSweeps];  // [y % kept_rows_][of WinnerRow][x]
  PathRows path_rows_[kSweeps];
  Strips strips_;
  std::vector<Worker> workers_;  // one per strip
  std::size_t penalty_stride_ = 0;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_SWEEPS_H
