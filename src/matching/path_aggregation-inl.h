// Path costs (eq. 6) of one pixel along the directions of one sweep. Included once per SIMD target.
#if defined(ADAPTIVE_GRID_STEREO_SRC_MATCHING_PATH_AGGREGATION_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef ADAPTIVE_GRID_STEREO_SRC_MATCHING_PATH_AGGREGATION_INL_H
#undef ADAPTIVE_GRID_STEREO_SRC_MATCHING_PATH_AGGREGATION_INL_H
#else
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_PATH_AGGREGATION_INL_H
#endif

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

// The path costs of the pixels that one pixel's paths come from.
struct Predecessors {
  const std::uint8_t* costs[kSweepDirections];  // disparity 0 of the direction
  std::uint8_t smallest[kSweepDirections];
  std::uint8_t limit[kSweepDirections];  // smallest + P2
};

HWY_INLINE std::uint8_t* PixelAt(const PathRow& row, int u, std::size_t pixel_stride) {
  return row.base + static_cast<std::size_t>((u + kPathMargin) & row.mask) * pixel_stride;
}

// Directions in the order of the plan: the first two belong to every pixel, the first four to cells
// of 8 paths, all to cells of 16. (du, dv) from the predecessor to the pixel: (1, 0), (0, 1), (1,
// 1), (-1, 1), (2, 1), (-2, 1), (1, 2), (-1, 2).
template <int kDirections>
HWY_INLINE void FindPredecessors(const SweepRow& row, const PathLayout& layout, int u,
                                 Predecessors* from) {
  const std::size_t stride = layout.pixel_stride;
  const std::uint8_t* pixels[kSweepDirections];
  pixels[0] = PixelAt(row.current, u - 1, stride);
  pixels[1] = PixelAt(row.above, u, stride);
  if (kDirections > 2) {
    pixels[2] = PixelAt(row.above, u - 1, stride);
    pixels[3] = PixelAt(row.above, u + 1, stride);
  }
  if (kDirections > 4) {
    pixels[4] = PixelAt(row.above, u - 2, stride);
    pixels[5] = PixelAt(row.above, u + 2, stride);
    pixels[6] = PixelAt(row.above2, u - 1, stride);
    pixels[7] = PixelAt(row.above2, u + 1, stride);
  }
  for (int r = 0; r < kDirections; ++r) {
    from->costs[r] = pixels[r] + kBlockPad + r * layout.block_stride;
    from->smallest[r] = pixels[r][r];
    from->limit[r] = static_cast<std::uint8_t>(pixels[r][r] + row.penalties[r][u]);
  }
}

// Eq. 6 without the matching cost: min(L(d), L(d +- 1) + P1, min L + P2) - min L, at most P2.
HWY_INLINE V8 Transition(D8 d, const std::uint8_t* costs, V8 penalty_small, V8 limit, V8 smallest) {
  const V8 neighbour = hn::Min(hn::LoadU(d, costs - 1), hn::LoadU(d, costs + 1));
  const V8 stepped = hn::SaturatedAdd(neighbour, penalty_small);
  return hn::Sub(hn::Min(hn::Min(hn::LoadU(d, costs), limit), stepped), smallest);
}

// Smallest lane of each of 2, 4 or 8 vectors, to as many bytes at `smallest` (8 bytes are written).
template <int kDirections>
HWY_INLINE void StoreSmallest(D8 d, const V8* v, std::uint8_t* smallest) {
  const hn::Repartition<std::uint32_t, D8> d32;
  const D16 d16;
  const auto merge8 = [&](V8 a, V8 b) HWY_ATTR {
    return hn::Min(hn::InterleaveLower(d, a, b), hn::InterleaveUpper(d, a, b));
  };
  V8 all = merge8(v[0], v[1]);
  if (kDirections > 2) {
    const auto merge16 = [&](V8 a, V8 b) HWY_ATTR {
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
  alignas(64) std::uint8_t blocks[HWY_MAX_BYTES];
  hn::Store(all, d, blocks);
  const hn::Full128<std::uint8_t> d128;
  auto block = hn::Load(d128, blocks);
  for (size_t b = 16; b < hn::Lanes(d); b += 16) {
    block = hn::Min(block, hn::Load(d128, blocks + b));
  }
  block = hn::Min(block, hn::ShiftRightBytes<8>(d128, block));
  if (kDirections < 8) block = hn::Min(block, hn::ShiftRightBytes<4>(d128, block));
  if (kDirections < 4) block = hn::Min(block, hn::ShiftRightBytes<2>(d128, block));
  hn::Store(hn::LowerHalf(block), hn::Half<decltype(d128)>(), smallest);
}

// The path costs of `kVectors` vectors of disparities from index k on, for all directions; returns
// the sums of the transitions (the matching cost is added later, once for all directions).
template <int kDirections, int kVectors, bool kFirst>
HWY_INLINE void AggregateVectors(D8 d, const Predecessors& from, const V8* cost, int k,
                                 V8 penalty_small, std::uint8_t* blocks, std::size_t block_stride,
                                 V8* smallest, ByteSums* sums) {
  const D16 d16;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int r = 0; r < kDirections; r += 2) {
    const V8 limit_a = hn::Set(d, from.limit[r]), limit_b = hn::Set(d, from.limit[r + 1]);
    const V8 offset_a = hn::Set(d, from.smallest[r]), offset_b = hn::Set(d, from.smallest[r + 1]);
    for (int i = 0; i < kVectors; ++i) {
      const int at = k + i * lanes;
      const V8 a = Transition(d, from.costs[r] + at, penalty_small, limit_a, offset_a);
      const V8 b = Transition(d, from.costs[r + 1] + at, penalty_small, limit_b, offset_b);
      const V8 path_a = hn::SaturatedAdd(a, cost[i]), path_b = hn::SaturatedAdd(b, cost[i]);
      hn::StoreU(path_a, d, blocks + r * block_stride + at);
      hn::StoreU(path_b, d, blocks + (r + 1) * block_stride + at);
      smallest[r] = kFirst && i == 0 ? path_a : hn::Min(smallest[r], path_a);
      smallest[r + 1] = kFirst && i == 0 ? path_b : hn::Min(smallest[r + 1], path_b);
      // Two transitions fit a byte. Their sums: `even` gathers even + 256 * odd modulo 65536.
      const V16 pair = hn::BitCast(d16, hn::Add(a, b));
      sums[i].even = r == 0 ? pair : hn::Add(sums[i].even, pair);
      const V16 high = hn::ShiftRight<8>(pair);
      sums[i].odd = r == 0 ? high : hn::Add(sums[i].odd, high);
    }
  }
  for (int i = 0; i < kVectors; ++i) {
    sums[i].even = hn::Sub(sums[i].even, hn::ShiftLeft<8>(sums[i].odd));
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace adaptive_grid_stereo
HWY_AFTER_NAMESPACE();

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_PATH_AGGREGATION_INL_H
