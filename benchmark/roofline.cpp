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
HWY_INLINE void AggregatePixel(const SweepRow& row, int u, V8 cost_of_all, V8 penalty_small) {
  const D8 d;
  const NearPlaces near{row.current[u], row.current[u - 1], row.above[u]};
  constexpr int kRange = 64;
  const int lanes = static_cast<int>(hn::Lanes(d));
  V8 smallest[kSweepDirections];
  for (int k = 0; k < kRange; k += lanes) {
    ByteSums sums[1];
    AggregateVectors<kSweepDirections, 1>(row, near, u, kRange, &cost_of_all, k, penalty_small,
                                          smallest, sums);
    sums[0].Finish();
    // The sums go where the smallest costs of no direction are, so that they are not optimised
    // away.
    hn::Store(hn::BitCast(d, hn::Xor(sums[0].even, sums[0].odd)), d,
              near.pixel + kPixelHeader + kSweepDirections * kRange);
  }
  StoreSmallest<kSweepDirections>(d, smallest, near.pixel);
}

HWY_ATTR void Recurrence(const SweepRow* rows, int width, int pixels) {
  const D8 d;
  const V8 cost = hn::Set(d, std::uint8_t{9}), penalty_small = hn::Set(d, std::uint8_t{14});
  for (int i = 0; i < pixels; i += kBandRows) {
    for (int r = 0; r < kBandRows; ++r) {
      const int lag = kBandLag * (kBandRows - 1 - r);
      AggregatePixel(rows[r], i / kBandRows % width + lag, cost, penalty_small);
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
  // the one before it). The first one's row above is the last one. A ring of eight pixels each.
  constexpr int kRange = 64, kRing = 8, kWidth = 64;
  constexpr std::size_t kStride = kPixelHeader + (kSweepDirections + 1) * kRange;
  alignas(64) static std::uint8_t costs[kBandRows * kRing * kStride + kMaxLanes];
  static const std::vector<std::uint8_t> penalties(penaltyPlace(2 * kPenaltyBlock, 0), 40);
  std::vector<std::uint8_t*> places[kBandRows];
  SweepRow rows[kBandRows] = {};
  for (int r = 0; r < kBandRows; ++r) {
    for (int i = 0; i < kWidth + kLargestLag + 2 * kPathMargin; ++i) {
      places[r].push_back(costs + (r * kRing + i % kRing) * kStride);
    }
  }
  for (int r = 0; r < kBandRows; ++r) {
    rows[r].penalties = penalties.data();
    rows[r].current = places[r].data() + kPathMargin;
    rows[r].above = places[(r + kBandRows - 1) % kBandRows].data() + kPathMargin;
    rows[r].above_diagonals = rows[r].above_knights = rows[r].above2_knights = rows[r].above;
  }
  HWY_DYNAMIC_DISPATCH(Recurrence)(rows, kWidth, pixels);
  return static_cast<std::int64_t>(pixels) * kRange * kSweepDirections;
}

}  // namespace adaptive_grid_stereo
#endif  // HWY_ONCE
