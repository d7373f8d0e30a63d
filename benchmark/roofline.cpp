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
  constexpr int kRange = 64;
  const int lanes = static_cast<int>(hn::Lanes(d));
  std::uint8_t* pixel = row.current[u];
  V8 smallest[kSweepDirections];
  for (int k = 0; k < kRange; k += lanes) {
    ByteSums sums[1];
    AggregateVectors<kSweepDirections, 1>(row, u, pixel, kRange, &cost_of_all, k, penalty_small,
                                          smallest, sums);
    sums[0].Finish();
    // The sums go where the smallest costs of no direction are, so that they are not optimised
    // away.
    hn::Store(hn::BitCast(d, hn::Xor(sums[0].even, sums[0].odd)), d,
              pixel + kPixelHeader + kSweepDirections * kRange);
  }
  StoreSmallest<kSweepDirections>(d, smallest, pixel);
}

HWY_ATTR void Recurrence(const SweepRow* rows, int row_count, int width, int pixels) {
  const D8 d;
  const V8 cost = hn::Set(d, std::uint8_t{9}), penalty_small = hn::Set(d, std::uint8_t{14});
  for (int i = 0; i < pixels; i += row_count) {
    for (int r = 0; r < row_count; ++r) {
      AggregatePixel(rows[r], i / row_count % width, cost, penalty_small);
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
  // Two rows take turns, as in a band; a ring of four pixels each.
  constexpr int kRange = 64, kRing = 4, kWidth = 64, kRows = 2;
  constexpr std::size_t kStride = kPixelHeader + (kSweepDirections + 1) * kRange;
  alignas(64) static std::uint8_t costs[kRows * kRing * kStride + kMaxLanes];
  static const std::vector<std::uint8_t> penalties(kWidth * kSweepDirections, 40);
  std::vector<std::uint8_t*> places[kRows];
  SweepRow rows[kRows] = {};
  for (int r = 0; r < kRows; ++r) {
    for (int i = 0; i < kWidth + 2 * kPathMargin; ++i) {
      places[r].push_back(costs + (r * kRing + i % kRing) * kStride);
    }
  }
  for (int r = 0; r < kRows; ++r) {
    rows[r].penalties = penalties.data();
    rows[r].current = places[r].data() + kPathMargin;
    rows[r].above = places[1 - r].data() + kPathMargin;
    rows[r].above_diagonals = rows[r].above_knights = rows[r].above2_knights = rows[r].above;
  }
  HWY_DYNAMIC_DISPATCH(Recurrence)(rows, kRows, kWidth, pixels);
  return static_cast<std::int64_t>(pixels) * kRange * kSweepDirections;
}

}  // namespace adaptive_grid_stereo
#endif  // HWY_ONCE
