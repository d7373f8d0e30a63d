#include "adaptive_grid_stereo/matching/stereo_matcher.h"

#include <algorithm>
#include <atomic>
#include <stdexcept>
#include <thread>

#include "adaptive_grid_stereo/matching/padded_image.h"
#include "adaptive_grid_stereo/matching/refinement.h"
#include "adaptive_grid_stereo/matching/simd_target.h"
#include "src/matching/row_parts.h"
#include "src/matching/stopwatch.h"
#include "src/matching/sweeps.h"
#include "src/matching/thread_pool.h"

namespace adaptive_grid_stereo {
namespace {

void checkConfig(const MatcherConfig& config) {
  MatcherConfig legal = config;
  const std::vector<std::string> sentences = legal.validate();
  if (!sentences.empty()) throw std::invalid_argument(sentences.front());
}

std::string describe(const cv::Mat& image) {
  return std::to_string(image.cols) + "x" + std::to_string(image.rows) + " " +
         cv::typeToString(image.type());
}

void checkImages(const cv::Mat& left, const cv::Mat& right) {
  if (left.type() != CV_8UC1 || right.type() != CV_8UC1 || left.size() != right.size() ||
      left.cols < kMinImageSide || left.rows < kMinImageSide) {
    throw std::invalid_argument("left image is " + describe(left) + ", right image is " +
                                describe(right) + "; expected two CV_8UC1 images of one size, " +
                                std::to_string(kMinImageSide) + " pixels a side at least");
  }
}

int threadCount(const MatcherConfig& config) {
  if (config.threads > 0) return config.threads;
  return std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, 64);
}

}  // namespace

struct StereoMatcher::Impl {
  MatcherConfig config;
  MatchResult result;
  std::unique_ptr<ThreadPool> pool;
  PaddedImage left, left_mirrored, right_mirrored;
  Sweeps sweeps;
  SmallRegions regions;
  cv::Mat unfiltered;
  std::atomic<bool> stop{false};

  void pad(const cv::Mat& left_image, const cv::Mat& right_image);
  void refine();
};

StereoMatcher::StereoMatcher(const MatcherConfig& config) : impl_(new Impl) {
  simdTarget();  // finds out now what the CPU has, so that the first frame does not pay for it
  setConfig(config);
}

StereoMatcher::~StereoMatcher() = default;

void StereoMatcher::setConfig(const MatcherConfig& config) {
  checkConfig(config);
  impl_->config = config;
  const int threads = threadCount(config);
  if (!impl_->pool || impl_->pool->size() != threads) impl_->pool.reset(new ThreadPool(threads));
}

const MatcherConfig& StereoMatcher::config() const { return impl_->config; }

void StereoMatcher::cancel() { impl_->stop = true; }

void StereoMatcher::Impl::pad(const cv::Mat& left_image, const cv::Mat& right_image) {
  left.reserve(left_image);
  left_mirrored.reserve(left_image);
  right_mirrored.reserve(right_image);
  forRowParts(left_image.rows, pool.get(), [&](int, RowRange rows) {
    left.copyRows(left_image, false, rows.first, rows.last);
    left_mirrored.copyRows(left_image, true, rows.first, rows.last);
    right_mirrored.copyRows(right_image, true, rows.first, rows.last);
  });
}

void StereoMatcher::Impl::refine() {
  // A thread's part is about that of the rows that it has selected, which are in its caches.
  const auto forParts = [&](const auto& f) { forRowParts(unfiltered.rows, pool.get(), f); };
  if (config.min_contrast > 0.0) {
    forParts([&](int, RowRange rows) {
      removeLowContrast(left, config.census_window, config.min_contrast, rows.first, rows.last,
                        &unfiltered);
    });
  }
  if (config.speckle_size > 0) {
    regions.start(unfiltered, config.speckle_range * kDisparityScale, pool->size());
    pool->run([&](int part) { regions.find(part); });
    regions.join();
    pool->run([&](int part) { regions.erase(part, config.speckle_size, &unfiltered); });
  }
  if (!config.median_filter) {
    unfiltered.copyTo(result.disparity);
    return;
  }
  forParts([&](int, RowRange rows) {
    medianOfValid(unfiltered, rows.first, rows.last, &result.disparity);
  });
}

const MatchResult& StereoMatcher::match(const cv::Mat& left, const cv::Mat& right,
                                        const PathPlan& plan) {
  checkImages(left, right);
  checkPlan(plan, left.cols, left.rows);
  Impl& impl = *impl_;
  MatchResult& result = impl.result;
  const Stopwatch total;
  impl.pad(left, right);
  const double padding = total.milliseconds();

  const Stopwatch sweeps;
  impl.unfiltered.create(left.size(), CV_16SC1);
  result.disparity.create(left.size(), CV_16SC1);
  impl.sweeps.prepare(left.cols, left.rows, impl.config, impl.pool->size());
  impl.sweeps.run({&impl.left, &impl.left_mirrored, &impl.right_mirrored}, plan, impl.stop,
                  impl.pool.get(), &impl.unfiltered);
  if (impl.stop) throw MatchCancelled();
  result.times.census = padding + impl.sweeps.censusTime();
  result.times.sweeps = sweeps.milliseconds() - impl.sweeps.censusTime();

  const Stopwatch refinement;
  impl.refine();
  result.times.refinement = refinement.milliseconds();

  result.min_disparity = impl.config.min_disparity;
  result.disparity_range = impl.config.disparity_range;
  result.times.total = total.milliseconds();
  return result;
}

cv::Mat toFloatDisparity(const MatchResult& result) {
  cv::Mat disparity;
  result.disparity.convertTo(disparity, CV_32F, 1.0 / kDisparityScale, result.min_disparity);
  return disparity;
}

}  // namespace adaptive_grid_stereo
