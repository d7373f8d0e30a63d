#ifndef ADAPTIVE_GRID_STEREO_SRC_MATCHING_SWEEPS_H
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_SWEEPS_H

#include <cstdint>
#include <memory>
#include <vector>

#include <opencv2/core.hpp>

#include "adaptive_grid_stereo/matching/padded_image.h"
#include "adaptive_grid_stereo/path_plan.h"
#include "src/matching/aligned_buffer.h"
#include "src/matching/pixel_kinds.h"
#include "src/matching/row_selection.h"
#include "src/matching/sweep.h"
#include "src/matching/thread_pool.h"

namespace adaptive_grid_stereo {

/// What the sweeps read of a frame.
struct SweepImages {
  const PaddedImage* left = nullptr;
  const PaddedImage* left_mirrored = nullptr;
  const std::uint8_t* left_census = nullptr;   // [y * planes * censusStride]
  const std::uint8_t* right_census = nullptr;  // of the mirrored right image
};

/// Runs the two sweeps over an image: bands of rows go round the threads, each band follows the one
/// above it as closely as its paths allow. Owns all buffers of path costs, and the volume between
/// the sweeps.
class Sweeps {
 public:
  /// Makes buffers for the size and range where they are too small.
  void prepare(int width, int height, const MatcherConfig& config, int threads);

  /// disparity: CV_16SC1 of the image's size, filled with the disparities before refinement.
  void run(const SweepImages& images, const PathPlan& plan, ThreadPool* pool, cv::Mat* disparity);

 private:
  struct Worker {
    AlignedBuffer<std::uint8_t> rings;       // path costs of the rows within a band
    std::vector<std::uint8_t*> ring_places;  // [row][u]
    AlignedBuffer<std::uint8_t> penalties;   // [row][u][direction]
    std::vector<Winner> winners;             // [row][x]
    RightClaims claims;
  };

  void runSweep(const SweepImages& images, bool second, ThreadPool* pool, cv::Mat* disparity);
  void runBandOf(const SweepImages& images, bool second, int band, int threads, Worker* worker,
                 cv::Mat* disparity);
  void placePathCosts(int threads);
  void fillPathRows(int band, int row, int row_count, int threads, Worker* worker, SweepRow* out);
  void fillPenalties(const SweepImages& images, bool second, int v, int row, Worker* worker,
                     SweepRow* out);

  MatcherConfig config_;
  SweepFrame frame_;
  std::uint8_t penalty_table_[256] = {};
  PixelKinds kinds_[2];
  std::vector<std::uint8_t> shifts_;  // [row cell][x]
  PathPlan plan_;
  AlignedBuffer<std::uint16_t> volume_;
  AlignedBuffer<std::uint8_t> boundary_rows_;   // two rows of path costs per slot
  std::vector<std::uint8_t*> boundary_places_;  // [row][u]
  AlignedBuffer<std::uint8_t> zero_pixel_;
  std::vector<std::uint8_t*> zero_places_;  // [u]
  std::unique_ptr<BandProgress[]> progress_;
  int progress_size_ = 0;
  std::vector<Worker> workers_;
  std::size_t penalty_stride_ = 0;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_SWEEPS_H
