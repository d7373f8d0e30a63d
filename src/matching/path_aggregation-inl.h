// Path costs (eq. 6) of one pixel along the directions of one sweep. Included once per SIMD target.
#if defined(ADAPTIVE_GRID_STEREO_SRC_MATCHING_PATH_AGGREGATION_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef ADAPTIVE_GRID_STEREO_SRC_MATCHING_PATH_AGGREGATION_INL_H
#undef ADAPTIVE_GRID_STEREO_SRC_MATCHING_PATH_AGGREGATION_INL_H
#else
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_PATH_AGGREGATION_INL_H
#endif

#include <cstring>

#include "src/matching/repeat-inl.h"
#include "src/matching/sweep.h"

HWY_BEFORE_NAMESPACE();
namespace adaptive_grid_stereo {
namespace HWY_NAMESPACE {
namespace hn = AGS_SIMD;

using D8 = hn::ScalableTag<std::uint8_t>;
using D16 = hn::Repartition<std::uint16_t, D8>;
using V8 = hn::Vec<D8>;
using V16 = hn::Vec<D16>;

// Whether vectors are arrays that plain loops go through (portable_simd.h).
constexpr bool kPlainCpp = HWY_TARGET == HWY_SCALAR;

// Constructors, because Arm's vectors have one that must be inlined, which only functions with the
// target's attributes can do.

// Sums of transitions in 16 bits, of the even and of the odd disparities apart. They come as the
// sums of two directions, which fit a byte; until Finish(), `even` gathers even + 256 * odd modulo
// 65536.
struct ByteSums {
  HWY_ATTR ByteSums() {}
  HWY_ATTR ByteSums(V16 even_sums, V16 odd_sums) : even(even_sums), odd(odd_sums) {}
  template <bool kFirst>
  HWY_INLINE void AddPair(V8 pair) {
    const V16 both = hn::BitCast(D16(), pair), high = hn::ShiftRight<8>(both);
    even = kFirst ? both : hn::Add(even, both);
    odd = kFirst ? high : hn::Add(odd, high);
  }
  HWY_INLINE void Finish() { even = hn::Sub(even, hn::ShiftLeft<8>(odd)); }
  V16 even, odd;
};

// The sum of two such pairs modulo 256, and the second one, by which to tell whether the sum is
// larger.
struct LowSums {
  HWY_ATTR LowSums() {}
  template <bool kFirst>
  HWY_INLINE void AddPair(V8 pair) {
    low = kFirst ? pair : hn::Add(low, pair);
    last = pair;
  }
  V8 low, last;
};

// Where the path costs of a pixel and of those lie that its paths come from.
struct NearPlaces {
  HWY_INLINE NearPlaces(const PathPlaces& of_band, int step, int row)
      : places(of_band), at(kPlacesPerStep * static_cast<std::ptrdiff_t>(step) + row) {}
  HWY_INLINE std::uint8_t* pixel() const { return places.all[at]; }

  const PathPlaces& places;
  std::ptrdiff_t at;  // of the pixel
};

// The path costs of the pixel that direction r comes from. Directions are in the order of the plan:
// the first two belong to every pixel, the first four to cells of 8 paths, all to cells of 16.
template <int kDirection>
HWY_INLINE const std::uint8_t* Predecessor(const NearPlaces& near) {
  // (du, dv) from the predecessor to the pixel.
  constexpr int kMove[kSweepDirections][2] = {{1, 0}, {0, 1},  {1, 1}, {-1, 1},
                                              {2, 1}, {-2, 1}, {1, 2}, {-1, 2}};
  constexpr int kColumns = kMove[kDirection][0], kRows = kMove[kDirection][1];
  // A row above has had the pixel above kBandLag steps before.
  constexpr int kBack = kPlacesPerStep * (kColumns + kBandLag * kRows) + kRows;
  const PathPlaces& places = near.places;
  const StepPlaces seen = kDirection < 2 ? places.all : kDirection < 4 ? places.four : places.eight;
  return seen[near.at - kBack];
}

// How often a pixel's header has the smallest path cost of each direction. Four equal bytes are
// spread over a vector by loading alone; a single one takes the CPU's port that moves bytes, too,
// which with 64 disparities is 2 % of a frame on an Intel Xeon.
#if HWY_TARGET == HWY_AVX3_DL
constexpr int kSmallestCopies = 4;
#else
constexpr int kSmallestCopies = 1;
#endif
static_assert(kSmallestCopies * kSweepDirections <= kPixelHeader, "the header must hold them");

HWY_INLINE V8 SmallestAt(D8 d, const std::uint8_t* from) {
  if (kSmallestCopies == 1) return hn::Set(d, *from);
  std::uint32_t four;
  std::memcpy(&four, from, sizeof(four));
  return hn::BitCast(d, hn::Set(hn::Repartition<std::uint32_t, D8>(), four));
}

// The same address, whose origin compilers do not know: or else they put down, at every step, how
// far from the row's first penalty those of all directions are, and load that again for each row.
HWY_INLINE const std::uint8_t* Opaque(const std::uint8_t* address) {
  asm("" : "+r"(address));
  return address;
}

// One direction of one pixel, ready to go through the disparities.
struct Path {
  const std::uint8_t* from;  // path costs at the predecessor, disparity 0
  std::uint8_t* to;          // and at the pixel
  V8 smallest;               // min L at the predecessor
  V8 penalty;                // P2
};

template <int kDirection>
HWY_INLINE Path MakePath(D8 d, const NearPlaces& near, const std::uint8_t* penalties,
                         int padded_range) {
  const std::uint8_t* predecessor = Predecessor<kDirection>(near);
  const std::size_t block = kPixelHeader + kDirection * static_cast<std::size_t>(padded_range);
  const V8 smallest = SmallestAt(d, predecessor + kSmallestCopies * kDirection);
  const V8 penalty = hn::Set(d, penalties[penaltyPlace(0, kDirection)]);
  return {predecessor + block, near.pixel() + block, smallest, penalty};
}

// The path costs of a vector of disparities at the predecessor, and those one disparity below and
// above.
struct Neighbours {
  HWY_ATTR Neighbours() {}
  HWY_ATTR Neighbours(V8 at_disparity, V8 one_below, V8 one_above)
      : here(at_disparity), below(one_below), above(one_above) {}
  V8 here, below, above;
};

#if HWY_TARGET == HWY_AVX3_DL

// Indices of permutations by one byte, at whose end the byte stands again.
struct MovedBytes {
  alignas(64) std::uint8_t below[64], above[64];
};
constexpr MovedBytes makeMovedBytes() {
  MovedBytes from{};
  for (int i = 0; i < 64; ++i) {
    from.below[i] = static_cast<std::uint8_t>(i == 0 ? 0 : i - 1);
    from.above[i] = static_cast<std::uint8_t>(i == 63 ? 63 : i + 1);
  }
  return from;
}
static constexpr MovedBytes kMovedBytes = makeMovedBytes();

// Beyond either end of the range the cost at the end stands again, which costs P1 more there than
// where it is, so it never counts. There bytes move within a register; elsewhere they are loaded,
// though vectors as wide as cache lines make every such load touch two: a permutation of two
// vectors takes longer.
HWY_INLINE Neighbours LoadNeighbours(D8 d, const Path& path, int k, int padded_range) {
  const std::uint8_t* from = path.from + k;
  const V8 here = hn::Load(d, from);
  const auto moved = [&](const std::uint8_t* indices) AGS_LAMBDA {
    return V8{_mm512_permutexvar_epi8(_mm512_load_si512(indices), here.raw)};
  };
  const bool is_last = k + 64 == padded_range;
  return {here, k == 0 ? moved(kMovedBytes.below) : hn::LoadU(d, from - 1),
          is_last ? moved(kMovedBytes.above) : hn::LoadU(d, from + 1)};
}

#else

// Beyond either end of the range stands 255, where other bytes lie in memory.
HWY_INLINE Neighbours LoadNeighbours(D8 d, const Path& path, int k, int padded_range) {
  alignas(64) static constexpr std::uint8_t kBelow[kMaxLanes] = {255};
  alignas(64) static constexpr std::uint8_t kAbove[2 * kMaxLanes] = {
      0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,  0, 0,
      0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,  0, 0,
      0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 255};
  const std::uint8_t* from = path.from + k;
  const int lanes = static_cast<int>(hn::Lanes(d));
  V8 below = hn::LoadU(d, from - 1), above = hn::LoadU(d, from + 1);
  if (k == 0) below = hn::Or(below, hn::Load(d, kBelow));
  if (k + lanes == padded_range) above = hn::Or(above, hn::Load(d, kAbove + kMaxLanes - lanes));
  return {hn::Load(d, from), below, above};
}

#endif

// Eq. 6 without the matching cost: min(L(d), L(d +- 1) + P1, min L + P2) - min L, at most P2.
HWY_INLINE V8 Transition(const Path& path, const Neighbours& costs, V8 penalty_small) {
  const V8 stepped = hn::SaturatedAdd(hn::Min(costs.below, costs.above), penalty_small);
  return hn::Min(hn::Sub(hn::Min(costs.here, stepped), path.smallest), path.penalty);
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

#undef AGS_PAIRWISE_MIN
// Whether one instruction puts the minima of neighbouring lanes of two vectors side by side.
#if HWY_TARGET == HWY_NEON && HWY_ARCH_ARM_A64
#define AGS_PAIRWISE_MIN 1
#else
#define AGS_PAIRWISE_MIN 0
#endif

// Stores the smallest lane of each of 2, 4 or 8 vectors one after the other, kSmallestCopies times;
// may write 8 * kSmallestCopies bytes, to where these are aligned.
#if AGS_PAIRWISE_MIN

template <int kCount>
HWY_INLINE void StoreSmallest(D8 d, const V8* v, std::uint8_t* to) {
  V8 minima[kCount];
  for (int i = 0; i < kCount; ++i) minima[i] = v[i];
  for (int n = kCount / 2; n > 0; n /= 2) {
    for (int i = 0; i < n; ++i) {
      minima[i] = V8{vpminq_u8(minima[2 * i].raw, minima[2 * i + 1].raw)};
    }
  }
  for (int lanes = 16 / kCount; lanes > 1; lanes /= 2) {
    minima[0] = V8{vpminq_u8(minima[0].raw, minima[0].raw)};
  }
  const hn::Repartition<std::uint64_t, D8> d64;
  const auto bytes = hn::GetLane(hn::BitCast(d64, minima[0]));
  std::memcpy(to, &bytes, sizeof(bytes));
}

#else

template <int kCount>
HWY_INLINE void StoreSmallest(D8 d, const V8* v, std::uint8_t* to) {
  const hn::Repartition<std::uint32_t, D8> d32;
  const D16 d16;
  const auto merge8 = [&](V8 a, V8 b) AGS_LAMBDA {
    return hn::Min(hn::InterleaveLower(d, a, b), hn::InterleaveUpper(d, a, b));
  };
  V8 all = merge8(v[0], v[1]);
  if constexpr (kCount > 2) {
    const auto merge16 = [&](V8 a, V8 b) AGS_LAMBDA {
      const V16 a16 = hn::BitCast(d16, a), b16 = hn::BitCast(d16, b);
      return hn::Min(hn::BitCast(d, hn::InterleaveLower(d16, a16, b16)),
                     hn::BitCast(d, hn::InterleaveUpper(d16, a16, b16)));
    };
    all = merge16(all, merge8(v[2], v[3]));
    if constexpr (kCount > 4) {
      const auto rest = merge16(merge8(v[4], v[5]), merge8(v[6], v[7]));
      const auto a32 = hn::BitCast(d32, all), b32 = hn::BitCast(d32, rest);
      all = hn::Min(hn::BitCast(d, hn::InterleaveLower(d32, a32, b32)),
                    hn::BitCast(d, hn::InterleaveUpper(d32, a32, b32)));
    }
  }
  auto block = FoldToBlock(all);
  const hn::Full128<std::uint8_t> d128;
  block = hn::Min(block, hn::ShiftRightBytes<8>(d128, block));
  if (kCount < 8) block = hn::Min(block, hn::ShiftRightBytes<4>(d128, block));
  if (kCount < 4) block = hn::Min(block, hn::ShiftRightBytes<2>(d128, block));
#if HWY_TARGET == HWY_AVX3_DL
  alignas(32) static constexpr std::uint8_t kFourEach[32] = {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2,
                                                             2, 3, 3, 3, 3, 4, 4, 4, 4, 5, 5,
                                                             5, 5, 6, 6, 6, 6, 7, 7, 7, 7};
  const auto four_each = _mm256_load_si256(reinterpret_cast<const __m256i*>(kFourEach));
  const __m256i copies = _mm256_permutexvar_epi8(four_each, _mm256_castsi128_si256(block.raw));
  _mm256_store_si256(reinterpret_cast<__m256i*>(to), copies);
#else
  const auto bytes = hn::GetLane(hn::BitCast(hn::Full128<std::uint64_t>(), block));
  std::memcpy(to, &bytes, sizeof(bytes));
#endif
}

#endif

// The path costs of `kVectors` vectors of disparities from index k on, for all directions; adds the
// transitions to the sums, which are not finished then. (The matching cost is added later, once for
// all directions.)
template <int kDirections, int kVectors, class Sums>
HWY_INLINE void AggregateVectors(const SweepRow& row, const NearPlaces& near, int step,
                                 int padded_range, const V8* cost, int k, V8 penalty_small,
                                 V8* smallest, Sums* sums) {
  const D8 d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const std::uint8_t* penalties = Opaque(row.penalties + penaltyPlace(step, 0));
  Repeat<kDirections / 2>([&](auto pair_of) AGS_LAMBDA {
    constexpr int kA = 2 * decltype(pair_of)::value, kB = kA + 1;
    const Path path_a = MakePath<kA>(d, near, penalties, padded_range);
    const Path path_b = MakePath<kB>(d, near, penalties, padded_range);
    Repeat<kVectors>([&](auto vector) AGS_LAMBDA {
      constexpr int i = decltype(vector)::value;
      const int at = k + i * lanes;
      const V8 a = Transition(path_a, LoadNeighbours(d, path_a, at, padded_range), penalty_small);
      const V8 b = Transition(path_b, LoadNeighbours(d, path_b, at, padded_range), penalty_small);
      const V8 cost_a = hn::SaturatedAdd(a, cost[i]), cost_b = hn::SaturatedAdd(b, cost[i]);
      hn::Store(cost_a, d, path_a.to + at);
      hn::Store(cost_b, d, path_b.to + at);
      smallest[kA] = at == 0 ? cost_a : hn::Min(smallest[kA], cost_a);
      smallest[kB] = at == 0 ? cost_b : hn::Min(smallest[kB], cost_b);
      sums[i].template AddPair<kA == 0>(hn::Add(a, b));
    });
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace adaptive_grid_stereo
HWY_AFTER_NAMESPACE();

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_PATH_AGGREGATION_INL_H
