#include "benchmark/roofline.h"

#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "benchmark/roofline.cpp"
#include "src/matching/simd-inl.h"
//
#include "src/matching/path_aggregation-inl.h"

HWY_BEFORE_NAMESPACE();
namespace adaptive_grid_stereo {
namespace HWY_NAMESPACE {
namespace hn = AGS_SIMD;

// One pixel's eight paths, 64 disparities.
HWY_INLINE void AggregatePixel(const SweepRow& row, const NearPlaces& near, int step,
                               V8 cost_of_all, V8 penalty_small) {
  const D8 d;
  constexpr int kRange = 64;
  const int lanes = static_cast<int>(hn::Lanes(d));
  V8 smallest[kSweepDirections];
  for (int k = 0; k < kRange; k += lanes) {
    ByteSums sums[1];
    AggregateVectors<kSweepDirections, 1>(row, near, step, kRange, &cost_of_all, k, penalty_small,
                                          smallest, sums);
    sums[0].Finish();
    // The sums go where the smallest costs of no direction are, so that they are not optimised
    // away.
    hn::Store(hn::BitCast(d, hn::Xor(sums[0].even, sums[0].odd)), d,
              near.pixel() + kPixelHeader + kSweepDirections * kRange);
  }
  StoreSmallest<kSweepDirections>(d, smallest, near.pixel());
}

HWY_ATTR void Recurrence(const SweepRow& row, const PathPlaces& places, int steps, int pixels) {
  const D8 d;
  const V8 cost = hn::Set(d, std::uint8_t{9}), penalty_small = hn::Set(d, std::uint8_t{14});
  for (int i = 0; i < pixels; i += kBandRows) {
    const int step = i / kBandRows % steps;
    for (int r = 0; r < kBandRows; ++r) {
      AggregatePixel(row, NearPlaces(places, step, r), step, cost, penalty_small);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace adaptive_grid_stereo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace adaptive_grid_stereo {
HWY_EXPORT(Recurrence);

std::int64_t runRecurrenceInCache(int pixels) {
  // Four rows take turns, each behind the one above, as in a band (or else a pixel would wait for
  // the one before it). The two rows above are the last ones. A ring of eight pixels each.
  constexpr int kRange = 64, kRing = 8, kSteps = 64;
  constexpr std::size_t kStride = kPixelHeader + (kSweepDirections + 1) * kRange;
  alignas(64) static std::uint8_t costs[kBandRows * kRing * kStride + kMaxLanes];
  static const std::vector<std::uint8_t> penalties(penaltyPlace(kSteps, 0), 40);
  std::vector<std::uint8_t*> table;
  for (int step = -kStepsBack; step < kSteps; ++step) {
    for (int r = -kRowsAbove; r < kBandRows; ++r) {
      const int u = step - kBandLag * r + kLargestLag + kRing;
      const int ring = (r + kBandRows) % kBandRows;
      table.push_back(costs + (ring * kRing + u % kRing) * kStride);
    }
  }
  const StepPlaces places = table.data() + kPlacesPerStep * kStepsBack + kRowsAbove;
  SweepRow row{};
  row.penalties = penalties.data();
  HWY_DYNAMIC_DISPATCH(Recurrence)(row, {places, places, places}, kSteps, pixels);
  return static_cast<std::int64_t>(pixels) * kRange * kSweepDirections;
}

}  // namespace adaptive_grid_stereo
#endif  // HWY_ONCE
