// The stages of the matcher one by one, and the rate of the path recurrence alone. Rates are items
// per second: pixels for the stages, path costs (pixel x disparity x path) for the recurrence and
// the sweeps.
#include <benchmark/benchmark.h>

#include "adaptive_grid_stereo/matching/census.h"
#include "adaptive_grid_stereo/matching/refinement.h"
#include "adaptive_grid_stereo/matching/stereo_matcher.h"
#include "benchmark/roofline.h"
#include "benchmark/textured_pair.h"

namespace adaptive_grid_stereo {
namespace {

constexpr int kWidth = 640, kHeight = 480;

void BM_Census(benchmark::State& state) {
  PaddedImage image;
  image.assign(makeTexturedPair(kWidth, kHeight, 64).left, false);
  std::vector<std::uint8_t> planes(8 * censusStride(kWidth));
  for (auto _ : state) {
    for (int y = 0; y < kHeight; ++y) {
      censusRow(image, false, y, CensusWindow::k9x7, planes.data());
    }
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * kWidth * kHeight);
}
BENCHMARK(BM_Census)->Unit(benchmark::kMillisecond);

cv::Mat matched(bool refined) {
  const TexturedPair pair = makeTexturedPair(kWidth, kHeight, 64);
  MatcherConfig config;
  if (!refined) {
    config.speckle_size = 0;
    config.median_filter = false;
  }
  StereoMatcher matcher(config);
  return matcher.match(pair.left, pair.right, uniformPlan(kWidth, kHeight, 8)).disparity.clone();
}

void BM_SmallRegions(benchmark::State& state) {
  const cv::Mat disparity = matched(false);
  SmallRegions regions;
  cv::Mat work;
  for (auto _ : state) {
    disparity.copyTo(work);
    removeSmallRegions(100, 3 * kDisparityScale, &regions, &work);
  }
  state.SetItemsProcessed(state.iterations() * kWidth * kHeight);
}
BENCHMARK(BM_SmallRegions)->Unit(benchmark::kMillisecond);

void BM_Median(benchmark::State& state) {
  const cv::Mat disparity = matched(false);
  cv::Mat result(disparity.size(), CV_16SC1);
  for (auto _ : state) medianOfValid(disparity, 0, kHeight, &result);
  state.SetItemsProcessed(state.iterations() * kWidth * kHeight);
}
BENCHMARK(BM_Median)->Unit(benchmark::kMillisecond);

void BM_RecurrenceInCache(benchmark::State& state) {
  std::int64_t count = 0;
  for (auto _ : state) count += runRecurrenceInCache(1 << 16);
  state.SetItemsProcessed(count);
}
BENCHMARK(BM_RecurrenceInCache)->Unit(benchmark::kMillisecond);

// Both sweeps: costs, aggregation and selection of a whole image, one thread.
void BM_Sweeps(benchmark::State& state) {
  const int paths = static_cast<int>(state.range(0));
  const TexturedPair pair = makeTexturedPair(kWidth, kHeight, 64);
  MatcherConfig config;
  config.threads = 1;
  StereoMatcher matcher(config);
  const PathPlan plan = uniformPlan(kWidth, kHeight, paths);
  for (auto _ : state) {
    state.SetIterationTime(matcher.match(pair.left, pair.right, plan).times.sweeps * 1e-3);
  }
  state.SetItemsProcessed(state.iterations() * kWidth * kHeight * 64 * paths);
}
BENCHMARK(BM_Sweeps)->Arg(16)->Arg(8)->Arg(4)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace adaptive_grid_stereo

int main(int argc, char** argv) {
  benchmark::AddCustomContext("simd_target", adaptive_grid_stereo::simdTarget());
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
