// Path costs (eq. 6) of one pixel along the directions of one sweep. Included once per SIMD target.
#if defined(ADAPTIVE_GRID_STEREO_SRC_MATCHING_PATH_AGGREGATION_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef ADAPTIVE_GRID_STEREO_SRC_MATCHING_PATH_AGGREGATION_INL_H
#undef ADAPTIVE_GRID_STEREO_SRC_MATCHING_PATH_AGGREGATION_INL_H
#else
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_PATH_AGGREGATION_INL_H
#endif

#include <type_traits>

#include "src/matching/sweep.h"

HWY_BEFORE_NAMESPACE();
namespace adaptive_grid_stereo {
namespace HWY_NAMESPACE {
namespace hn = AGS_SIMD;

using D8 = hn::ScalableTag<std::uint8_t>;
using D16 = hn::Repartition<std::uint16_t, D8>;
using V8 = hn::Vec<D8>;
using V16 = hn::Vec<D16>;

// Sums of bytes in 16 bits, of the even and of the odd disparities apart.
struct ByteSums {
  V16 even, odd;
};

// Calls f(integral_constant<int, i>) for i = 0 .. kCount - 1, unrolled.
template <int kCount, int kFirst = 0, class F>
HWY_INLINE void Repeat(const F& f) {
  if constexpr (kFirst < kCount) {
    f(std::integral_constant<int, kFirst>());
    Repeat<kCount, kFirst + 1>(f);
  }
}

// The pixel that direction r comes from. Directions are in the order of the plan: the first two
// belong to every pixel, the first four to cells of 8 paths, all to cells of 16. (du, dv) from the
// predecessor to the pixel: (1, 0), (0, 1), (1, 1), (-1, 1), (2, 1), (-2, 1), (1, 2), (-1, 2).
template <int kDirection>
HWY_INLINE const std::uint8_t* Predecessor(const SweepRow& row, int u) {
  switch (kDirection) {
    case 0:
      return row.current[u - 1];
    case 1:
      return row.above[u];
    case 2:
      return row.above[u - 1];
    case 3:
      return row.above[u + 1];
    case 4:
      return row.above[u - 2];
    case 5:
      return row.above[u + 2];
    case 6:
      return row.above2[u - 1];
    default:
      return row.above2[u + 1];
  }
}

// One direction of one pixel, ready to go through the disparities.
struct Path {
  const std::uint8_t* from;  // path costs at the predecessor, disparity 0
  std::uint8_t* to;          // and at the pixel
  V8 smallest;               // min L at the predecessor
  V8 limit;                  // the same + P2
};

template <int kDirection>
HWY_INLINE Path MakePath(D8 d, const SweepRow& row, int u, std::uint8_t* pixel, int padded_range) {
  const std::uint8_t* predecessor = Predecessor<kDirection>(row, u);
  const std::size_t block = kPixelHeader + kDirection * static_cast<std::size_t>(padded_range);
  const V8 smallest = hn::Set(d, predecessor[kDirection]);
  const V8 penalty = hn::Set(d, row.penalties[u * kSweepDirections + kDirection]);
  return {predecessor + block, pixel + block, smallest, hn::Add(smallest, penalty)};
}

// Whether a vector of disparities begins or ends the range.
struct RangeEnds {
  bool first, last;
};

// Eq. 6 without the matching cost: min(L(d), L(d +- 1) + P1, min L + P2) - min L, at most P2.
HWY_INLINE V8 Transition(D8 d, const Path& path, int k, const RangeEnds& ends, V8 penalty_small) {
  // 255 stands for the cost beyond either end of the range, where other bytes lie in memory.
  alignas(64) static constexpr std::uint8_t kBelow[kMaxLanes] = {255};
  alignas(64) static constexpr std::uint8_t kAbove[2 * kMaxLanes] = {
      0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,  0, 0,
      0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,  0, 0,
      0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 255};
  const std::uint8_t* from = path.from + k;
  V8 below = hn::LoadU(d, from - 1), above = hn::LoadU(d, from + 1);
  if (ends.first) below = hn::Or(below, hn::Load(d, kBelow));
  if (ends.last) above = hn::Or(above, hn::Load(d, kAbove + kMaxLanes - hn::Lanes(d)));
  const V8 stepped = hn::SaturatedAdd(hn::Min(below, above), penalty_small);
  return hn::Sub(hn::Min(hn::Min(hn::Load(d, from), path.limit), stepped), path.smallest);
}

// Minimum over the blocks of 16 bytes.
HWY_INLINE auto FoldToBlock(V8 v) {
#if HWY_TARGET == HWY_AVX2
  return hn::Min(hn::LowerHalf(v), hn::UpperHalf(hn::Half<D8>(), v));
#elif HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
  const auto half = hn::Min(hn::LowerHalf(v), hn::UpperHalf(hn::Half<D8>(), v));
  return hn::Min(hn::LowerHalf(half), hn::UpperHalf(hn::Half<hn::Half<D8> >(), half));
#else
  return v;
#endif
}

// Smallest lane of each of 2, 4 or 8 vectors, to as many bytes at `smallest` (8 bytes are written).
template <int kDirections>
HWY_INLINE void StoreSmallest(D8 d, const V8* v, std::uint8_t* smallest) {
  const hn::Repartition<std::uint32_t, D8> d32;
  const D16 d16;
  const auto merge8 = [&](V8 a, V8 b) AGS_LAMBDA {
    return hn::Min(hn::InterleaveLower(d, a, b), hn::InterleaveUpper(d, a, b));
  };
  V8 all = merge8(v[0], v[1]);
  if (kDirections > 2) {
    const auto merge16 = [&](V8 a, V8 b) AGS_LAMBDA {
      const V16 a16 = hn::BitCast(d16, a), b16 = hn::BitCast(d16, b);
      return hn::Min(hn::BitCast(d, hn::InterleaveLower(d16, a16, b16)),
                     hn::BitCast(d, hn::InterleaveUpper(d16, a16, b16)));
    };
    all = merge16(all, merge8(v[2], v[3]));
    if (kDirections > 4) {
      const auto rest = merge16(merge8(v[4], v[5]), merge8(v[6], v[7]));
      const auto a32 = hn::BitCast(d32, all), b32 = hn::BitCast(d32, rest);
      all = hn::Min(hn::BitCast(d, hn::InterleaveLower(d32, a32, b32)),
                    hn::BitCast(d, hn::InterleaveUpper(d32, a32, b32)));
    }
  }
  auto block = FoldToBlock(all);
  const hn::Full128<std::uint8_t> d128;
  block = hn::Min(block, hn::ShiftRightBytes<8>(d128, block));
  if (kDirections < 8) block = hn::Min(block, hn::ShiftRightBytes<4>(d128, block));
  if (kDirections < 4) block = hn::Min(block, hn::ShiftRightBytes<2>(d128, block));
  hn::Store(hn::LowerHalf(block), hn::Half<decltype(d128)>(), smallest);
}

// The path costs of `kVectors` vectors of disparities from index k on, for all directions; returns
// the sums of the transitions (the matching cost is added later, once for all directions).
template <int kDirections, int kVectors>
HWY_INLINE void AggregateVectors(const SweepRow& row, int u, std::uint8_t* pixel, int padded_range,
                                 const V8* cost, int k, V8 penalty_small, V8* smallest,
                                 ByteSums* sums) {
  const D8 d;
  const D16 d16;
  const int lanes = static_cast<int>(hn::Lanes(d));
  Repeat<kDirections / 2>([&](auto pair_of) AGS_LAMBDA {
    constexpr int kA = 2 * decltype(pair_of)::value, kB = kA + 1;
    const Path path_a = MakePath<kA>(d, row, u, pixel, padded_range);
    const Path path_b = MakePath<kB>(d, row, u, pixel, padded_range);
    Repeat<kVectors>([&](auto vector) AGS_LAMBDA {
      constexpr int i = decltype(vector)::value;
      const int at = k + i * lanes;
      const RangeEnds ends = {at == 0, at + lanes == padded_range};
      const V8 a = Transition(d, path_a, at, ends, penalty_small);
      const V8 b = Transition(d, path_b, at, ends, penalty_small);
      const V8 cost_a = hn::SaturatedAdd(a, cost[i]), cost_b = hn::SaturatedAdd(b, cost[i]);
      hn::Store(cost_a, d, path_a.to + at);
      hn::Store(cost_b, d, path_b.to + at);
      smallest[kA] = ends.first ? cost_a : hn::Min(smallest[kA], cost_a);
      smallest[kB] = ends.first ? cost_b : hn::Min(smallest[kB], cost_b);
      // Two transitions fit a byte. Their sums: `even` gathers even + 256 * odd modulo 65536.
      const V16 pair = hn::BitCast(d16, hn::Add(a, b));
      const V16 high = hn::ShiftRight<8>(pair);
      sums[i].even = kA == 0 ? pair : hn::Add(sums[i].even, pair);
      sums[i].odd = kA == 0 ? high : hn::Add(sums[i].odd, high);
    });
  });
  for (int i = 0; i < kVectors; ++i) {
    sums[i].even = hn::Sub(sums[i].even, hn::ShiftLeft<8>(sums[i].odd));
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace adaptive_grid_stereo
HWY_AFTER_NAMESPACE();

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_PATH_AGGREGATION_INL_H
