// Hamming distances of one pixel (eq. 4), for all disparities. Included once per SIMD target.
#if defined(ADAPTIVE_GRID_STEREO_SRC_MATCHING_MATCHING_COST_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef ADAPTIVE_GRID_STEREO_SRC_MATCHING_MATCHING_COST_INL_H
#undef ADAPTIVE_GRID_STEREO_SRC_MATCHING_MATCHING_COST_INL_H
#else
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_MATCHING_COST_INL_H
#endif

#include <algorithm>

#include "adaptive_grid_stereo/matching/census.h"
#include "src/matching/path_aggregation-inl.h"
#include "src/matching/sweep.h"

HWY_BEFORE_NAMESPACE();
namespace adaptive_grid_stereo {
namespace HWY_NAMESPACE {
namespace hn = AGS_SIMD;

#undef AGS_FAST_POPCOUNT
// Whether the target counts the bits of a byte in one instruction.
#if HWY_TARGET == HWY_AVX3_DL || HWY_TARGET == HWY_NEON
#define AGS_FAST_POPCOUNT 1
#else
#define AGS_FAST_POPCOUNT 0
#endif

// Full adder, bit by bit: a + b + c = sum + 2 * carry.
template <class V>
HWY_INLINE void AddBits(V a, V b, V c, V* sum, V* carry) {
  const V half = hn::Xor(a, b);
  *sum = hn::Xor(half, c);
  *carry = hn::Or(hn::And(a, b), hn::And(half, c));
}

// Sum over the planes of the number of bits set in each byte.
template <int kPlanes, class V>
HWY_INLINE V CountBits(const V* x) {
  if (AGS_FAST_POPCOUNT || kPlanes < 6) {
    V count = hn::PopulationCount(x[0]);
    for (int p = 1; p < kPlanes; ++p) count = hn::Add(count, hn::PopulationCount(x[p]));
    return count;
  }
  // Counting by table is slow, so bits are added up across the planes first.
  V ones, twos, fours, sum_a, sum_b, carry_a, carry_b, carry_c;
  AddBits(x[0], x[1], x[2], &sum_a, &carry_a);
  AddBits(x[3], x[4], x[5], &sum_b, &carry_b);
  if (kPlanes == 6) {
    ones = hn::Xor(sum_a, sum_b);
    carry_c = hn::And(sum_a, sum_b);
  } else {
    AddBits(sum_a, sum_b, x[kPlanes - 2], &ones, &carry_c);
  }
  AddBits(carry_a, carry_b, carry_c, &twos, &fours);
  V high = hn::PopulationCount(fours);
  high = hn::Add(hn::Add(high, high), hn::PopulationCount(twos));
  V count = hn::Add(hn::Add(high, high), hn::PopulationCount(ones));
  if (kPlanes == 8) count = hn::Add(count, hn::PopulationCount(x[kPlanes - 1]));
  return count;
}

// Where the census bytes of a pixel and of its first disparity stand. In the mirrored row,
// disparity index k is k bytes further.
struct CensusPlaces {
  const std::uint8_t* left;
  const std::uint8_t* right;
  std::size_t stride;
  std::ptrdiff_t column;  // of the first disparity in the mirrored row
};

HWY_INLINE CensusPlaces FindCensus(const SweepFrame& frame, const SweepRow& row, int x) {
  const std::ptrdiff_t column = frame.width - 1 - x + frame.min_disparity;
  return {row.left + kCensusMargin + x, row.right + kCensusMargin + column,
          censusStride(frame.width), column};
}

// Costs of a vector of disparities from index k on.
template <int kPlanes>
HWY_INLINE V8 HammingDistances(const CensusPlaces& at, int k) {
  const D8 d;
  V8 different[kPlanes];
  for (int p = 0; p < kPlanes; ++p) {
    different[p] =
        hn::Xor(hn::Set(d, at.left[p * at.stride]), hn::LoadU(d, at.right + p * at.stride + k));
  }
  return CountBits<kPlanes>(different);
}

HWY_INLINE V8 HammingDistances(CensusWindow window, const CensusPlaces& at, int k) {
  switch (window) {
    case CensusWindow::k5x5:
      return HammingDistances<censusPlanes(CensusWindow::k5x5)>(at, k);
    case CensusWindow::k7x7:
      return HammingDistances<censusPlanes(CensusWindow::k7x7)>(at, k);
    case CensusWindow::k9x7:
      break;
  }
  return HammingDistances<censusPlanes(CensusWindow::k9x7)>(at, k);
}

// Costs of a vector of disparities of which some may leave the right image, where the largest cost
// stands, or lie beyond the range, where 255 stands.
HWY_INLINE V8 BorderCosts(const SweepFrame& frame, const CensusPlaces& at, int k) {
  const D8 d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const V8 largest = hn::Set(d, static_cast<std::uint8_t>(frame.window));
  const auto lanesBefore = [&](std::ptrdiff_t index) AGS_LAMBDA {
    return static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(index - k, 0, lanes));
  };
  const std::size_t begin = lanesBefore(-at.column), end = lanesBefore(frame.width - at.column);
  V8 costs = largest;
  if (begin < end) {
    costs = HammingDistances(frame.window, at, k);
    costs = hn::IfThenElse(hn::FirstN(d, end), costs, largest);
    costs = hn::IfThenElse(hn::FirstN(d, begin), largest, costs);
  }
  return hn::IfThenElse(hn::FirstN(d, lanesBefore(frame.layout.range)), costs,
                        hn::Set(d, std::uint8_t{255}));
}

}  // namespace HWY_NAMESPACE
}  // namespace adaptive_grid_stereo
HWY_AFTER_NAMESPACE();

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_MATCHING_COST_INL_H
