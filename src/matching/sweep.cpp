#include "src/matching/sweep.h"

#include <cstring>
#include <thread>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/matching/sweep.cpp"
#include "src/matching/simd-inl.h"
//
#include "src/matching/disparity_selection-inl.h"
#include "src/matching/matching_cost-inl.h"
#include "src/matching/path_aggregation-inl.h"

#if !defined(AGS_SWEEP_SHARED)
#define AGS_SWEEP_SHARED
namespace adaptive_grid_stereo {

// Largest range, rounded up to the widest vectors.
constexpr int kMaxRange = 512;

// Bits of the volume's 16 that hold the matching cost; the sum of the first sweep's transitions has
// the rest.
constexpr int kCostBits = 6;

// Waits until the band above has finished `column`; returns how far it has come.
inline int waitFor(const BandProgress& progress, int column) {
  int reached = progress.column.load(std::memory_order_acquire);
  for (int spins = 0; reached < column; ++spins) {
    if (spins > 64) std::this_thread::yield();
    reached = progress.column.load(std::memory_order_acquire);
  }
  return reached;
}

}  // namespace adaptive_grid_stereo
#endif  // AGS_SWEEP_SHARED

HWY_BEFORE_NAMESPACE();
namespace adaptive_grid_stereo {
namespace HWY_NAMESPACE {
namespace hn = AGS_SIMD;

// Sums in the order of the disparities.
HWY_INLINE void StoreInOrder(D16 d, V16 even, V16 odd, std::uint16_t* sums) {
  const V16 lower = hn::InterleaveLower(d, even, odd), upper = hn::InterleaveUpper(d, even, odd);
  const std::size_t lanes = hn::Lanes(d);
  if (lanes == 8) {
    hn::Store(lower, d, sums);
    hn::Store(upper, d, sums + 8);
    return;
  }
  // Interleaving works within blocks of 16 bytes, which have to be dealt out.
#if HWY_TARGET == HWY_AVX2
  hn::Store(hn::ConcatLowerLower(d, upper, lower), d, sums);
  hn::Store(hn::ConcatUpperUpper(d, upper, lower), d, sums + lanes);
#elif HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
  const hn::Repartition<std::uint64_t, D16> d64;
  alignas(64) static constexpr std::int64_t kPairs[8] = {0, 1, 4, 5, 2, 3, 6, 7};
  const auto indices = hn::SetTableIndices(d64, kPairs);
  const auto dealOut = [&](V16 blocks) HWY_ATTR {
    return hn::BitCast(d, hn::TableLookupLanes(hn::BitCast(d64, blocks), indices));
  };
  hn::Store(dealOut(hn::ConcatLowerLower(d, upper, lower)), d, sums);
  hn::Store(dealOut(hn::ConcatUpperUpper(d, upper, lower)), d, sums + lanes);
#endif
}

template <int kDirections, int kVectors, bool kFirst>
HWY_INLINE void FirstSweepVectors(const SweepFrame& frame, const SweepRow& row, int u,
                                  const std::uint8_t* costs, int k, std::uint8_t* pixel,
                                  V8* smallest, std::uint16_t* volume) {
  const D8 d;
  const D16 d16;
  const int lanes = static_cast<int>(hn::Lanes(d));
  V8 cost[kVectors];
  for (int i = 0; i < kVectors; ++i) cost[i] = hn::Load(d, costs + k + i * lanes);
  ByteSums sums[kVectors];
  AggregateVectors<kDirections, kVectors, kFirst>(
      row, u, pixel, frame.layout.block_stride, cost, k,
      hn::Set(d, static_cast<std::uint8_t>(frame.penalty_small)), smallest, sums);
  for (int i = 0; i < kVectors; ++i) {
    const V16 cost16 = hn::BitCast(d16, cost[i]);
    const V16 even = hn::Or(hn::ShiftLeft<kCostBits>(sums[i].even),
                            hn::And(cost16, hn::Set(d16, std::uint16_t{63})));
    const V16 odd = hn::Or(hn::ShiftLeft<kCostBits>(sums[i].odd), hn::ShiftRight<8>(cost16));
    hn::Store(even, d16, volume + k + i * lanes);
    hn::Store(odd, d16, volume + k + i * lanes + lanes / 2);
  }
}

template <int kDirections, int kVectors, bool kFirst>
HWY_INLINE void SecondSweepVectors(const SweepFrame& frame, const SweepRow& row, int u, int k,
                                   std::uint8_t* pixel, V8* smallest, const std::uint16_t* volume,
                                   std::uint16_t* all_sums) {
  const D8 d;
  const D16 d16;
  constexpr int kLogPaths = kDirections == 2 ? 2 : kDirections == 4 ? 3 : 4;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const V16 cost_mask = hn::Set(d16, std::uint16_t{63});
  V8 cost[kVectors];
  for (int i = 0; i < kVectors; ++i) {
    const V16 even = hn::And(hn::Load(d16, volume + k + i * lanes), cost_mask);
    const V16 odd = hn::And(hn::Load(d16, volume + k + i * lanes + lanes / 2), cost_mask);
    cost[i] = hn::BitCast(d, hn::Or(even, hn::ShiftLeft<8>(odd)));
    if (k + (i + 1) * lanes > frame.layout.range) {
      // Beyond the range the cost is 255, which the volume has no room for.
      const int inside = frame.layout.range - (k + i * lanes);
      cost[i] = hn::IfThenElse(hn::FirstN(d, inside > 0 ? inside : 0), cost[i],
                               hn::Set(d, std::uint8_t{255}));
    }
  }
  ByteSums sums[kVectors];
  AggregateVectors<kDirections, kVectors, kFirst>(
      row, u, pixel, frame.layout.block_stride, cost, k,
      hn::Set(d, static_cast<std::uint8_t>(frame.penalty_small)), smallest, sums);
  for (int i = 0; i < kVectors; ++i) {
    const V16 first_even = hn::Load(d16, volume + k + i * lanes);
    const V16 first_odd = hn::Load(d16, volume + k + i * lanes + lanes / 2);
    const V16 even = hn::Add(hn::Add(sums[i].even, hn::ShiftRight<kCostBits>(first_even)),
                             hn::ShiftLeft<kLogPaths>(hn::And(first_even, cost_mask)));
    const V16 odd = hn::Add(hn::Add(sums[i].odd, hn::ShiftRight<kCostBits>(first_odd)),
                            hn::ShiftLeft<kLogPaths>(hn::And(first_odd, cost_mask)));
    StoreInOrder(d16, even, odd, all_sums + k + i * lanes);
  }
}

template <int kDirections, bool kSecondSweep>
HWY_NOINLINE HWY_ATTR void SweepPixel(const SweepFrame& frame, const SweepRow& row, int u) {
  const D8 d;
  const PathLayout& layout = frame.layout;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const int x = kSecondSweep ? frame.width - 1 - u : u;
  std::uint8_t* pixel = row.current[u];
  std::uint16_t* volume = row.volume + static_cast<std::size_t>(x) * layout.padded_range;
  alignas(64) std::uint8_t costs[kSecondSweep ? 64 : kMaxRange];
  alignas(64) std::uint16_t sums[kSecondSweep ? kMaxRange : 32];
  if (!kSecondSweep) PixelCosts(frame, row.left, row.right, x, costs);
  V8 smallest[kSweepDirections];
  const auto vectors = [&](auto count, auto first, int k) HWY_ATTR {
    constexpr int kVectors = decltype(count)::value;
    constexpr bool kFirst = decltype(first)::value;
    if (kSecondSweep) {
      SecondSweepVectors<kDirections, kVectors, kFirst>(frame, row, u, k, pixel, smallest, volume,
                                                        sums);
    } else {
      FirstSweepVectors<kDirections, kVectors, kFirst>(frame, row, u, costs, k, pixel, smallest,
                                                       volume);
    }
  };
  using One = std::integral_constant<int, 1>;
  using Two = std::integral_constant<int, 2>;
  int k = 0;
  if (layout.padded_range >= 2 * lanes) {
    vectors(Two(), std::true_type(), 0);
    for (k = 2 * lanes; k + 2 * lanes <= layout.padded_range; k += 2 * lanes) {
      vectors(Two(), std::false_type(), k);
    }
    if (k < layout.padded_range) vectors(One(), std::false_type(), k);
  } else {
    vectors(One(), std::true_type(), 0);
  }
  StoreSmallest<kDirections>(d, smallest, pixel);
  if (kSecondSweep) SelectWinner(frame, sums, x, row.winners);
}

// Path costs of zero let the paths of the directions from `first` on start anew at their next
// pixel.
HWY_INLINE void ClearDirections(const PathLayout& layout, const PathRow& row, int u, int first) {
  std::uint8_t* pixel = row[u];
  for (int r = first; r < kSweepDirections; ++r) {
    pixel[r] = 0;
    std::memset(pixel + kBlockPad + r * layout.block_stride, 0, layout.range);
  }
}

template <bool kSecondSweep>
HWY_ATTR void SweepStep(const SweepFrame& frame, const SweepRow& row, int u) {
  const int kind = row.kinds[u];
  int first_unused = 0;
  switch (kind & ~kClearRest) {
    case kTwo:
      SweepPixel<2, kSecondSweep>(frame, row, u);
      first_unused = 2;
      break;
    case kFour:
      SweepPixel<4, kSecondSweep>(frame, row, u);
      first_unused = 4;
      break;
    case kEight:
      SweepPixel<8, kSecondSweep>(frame, row, u);
      return;
  }
  if (kind == kClear || (kind & kClearRest) != 0) {
    ClearDirections(frame.layout, row.current, u, first_unused);
  }
}

template <bool kSecondSweep>
HWY_ATTR void SweepBand(const SweepFrame& frame, const SweepRow* rows, int row_count,
                        const BandProgress* before, BandProgress* own) {
  // Progress is looked at and told once per so many pixels.
  constexpr int kStride = 16;
  const int begin = -kPathMargin, end = frame.width + kPathMargin;
  int reached = before ? begin - 1 : end;
  for (int step = begin; step < end + kBandLag * (row_count - 1); ++step) {
    const int needed = std::min(step + kPathMargin, end - 1);
    if (reached < needed) reached = waitFor(*before, std::min(step + kStride, end - 1));
    for (int r = 0; r < row_count; ++r) {
      const int u = step - kBandLag * r;
      if (u >= begin && u < end) SweepStep<kSecondSweep>(frame, rows[r], u);
    }
    if (step % kStride == 0) {
      own->column.store(step - kBandLag * (row_count - 1), std::memory_order_release);
    }
  }
  own->column.store(end, std::memory_order_release);
}

HWY_ATTR void RunBand(const SweepFrame& frame, bool second_sweep, const SweepRow* rows,
                      int row_count, const BandProgress* before, BandProgress* own) {
  if (second_sweep) {
    SweepBand<true>(frame, rows, row_count, before, own);
  } else {
    SweepBand<false>(frame, rows, row_count, before, own);
  }
}

HWY_ATTR int SweepLanes() { return static_cast<int>(hn::Lanes(D8())); }

// P2 of a vector of pixels by their grey-level steps; `tables` sixteenths of the table have to be looked up.
HWY_INLINE V8 LookUpPenalties(D8 d, const std::uint8_t* table, int tables, V8 step) {
  const V8 index = hn::And(step, hn::Set(d, std::uint8_t{15}));
  V8 penalty = hn::Set(d, table[255]);
  for (int t = tables - 1; t >= 0; --t) {
    const V8 entries = hn::TableLookupBytes(hn::LoadDup128(d, table + 16 * t), index);
    const V8 last = hn::Set(d, static_cast<std::uint8_t>(16 * t + 15));
    penalty = hn::IfThenElse(hn::Eq(hn::Min(step, last), step), entries, penalty);
  }
  return penalty;
}

HWY_ATTR void PenaltyRow(const std::uint8_t* current, const std::uint8_t* const* previous,
                         int directions, int width, const std::uint8_t* table,
                         std::uint8_t* penalties) {
  const D8 d;
  // The table falls until it stays at its last value; only that part has to be looked up.
  int tables = 16;
  while (tables > 1 && table[16 * (tables - 1) - 1] == table[255]) --tables;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int u = 0; u < width; u += lanes) {
    const V8 grey = hn::LoadU(d, current + u);
    alignas(64) std::uint8_t by_direction[kSweepDirections][kMaxLanes] = {};
    for (int r = 0; r < directions; ++r) {
      const V8 other = hn::LoadU(d, previous[r] + u);
      const V8 step = hn::Sub(hn::Max(grey, other), hn::Min(grey, other));
      hn::Store(LookUpPenalties(d, table, tables, step), d, by_direction[r]);
    }
    std::uint8_t* out = penalties + static_cast<std::size_t>(u) * kSweepDirections;
    for (int i = 0; i < lanes; ++i) {
      for (int r = 0; r < kSweepDirections; ++r) {
        out[i * kSweepDirections + r] = by_direction[r][i];
      }
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace adaptive_grid_stereo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace adaptive_grid_stereo {
HWY_EXPORT(RunBand);
HWY_EXPORT(SweepLanes);
HWY_EXPORT(PenaltyRow);

int sweepLanes() { return HWY_DYNAMIC_DISPATCH(SweepLanes)(); }

void runBand(const SweepFrame& frame, bool second_sweep, const SweepRow* rows, int row_count,
             const BandProgress* before, BandProgress* own) {
  HWY_DYNAMIC_DISPATCH(RunBand)(frame, second_sweep, rows, row_count, before, own);
}

void penaltyRow(const std::uint8_t* current, const std::uint8_t* const* previous, int directions,
                int width, const std::uint8_t* table, std::uint8_t* penalties) {
  HWY_DYNAMIC_DISPATCH(PenaltyRow)(current, previous, directions, width, table, penalties);
}

}  // namespace adaptive_grid_stereo
#endif  // HWY_ONCE
