// Hamming distances of one pixel (eq. 4), for all disparities. Included once per SIMD target.
#if defined(ADAPTIVE_GRID_STEREO_SRC_MATCHING_MATCHING_COST_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef ADAPTIVE_GRID_STEREO_SRC_MATCHING_MATCHING_COST_INL_H
#undef ADAPTIVE_GRID_STEREO_SRC_MATCHING_MATCHING_COST_INL_H
#else
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_MATCHING_COST_INL_H
#endif

#include <algorithm>
#include <cstring>

#include "adaptive_grid_stereo/matching/census.h"
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

template <int kPlanes>
HWY_INLINE void HammingDistances(const std::uint8_t* left, const std::uint8_t* right,
                                 std::size_t stride, int first, int last, std::uint8_t* costs) {
  const hn::ScalableTag<std::uint8_t> d;
  using V = hn::Vec<decltype(d)>;
  V bits[kPlanes > 0 ? kPlanes : 1];
  for (int p = 0; p < kPlanes; ++p) bits[p] = hn::Set(d, left[p * stride]);
  for (int k = first; k < last; k += static_cast<int>(hn::Lanes(d))) {
    V different[kPlanes > 0 ? kPlanes : 1];
    for (int p = 0; p < kPlanes; ++p) {
      different[p] = hn::Xor(bits[p], hn::LoadU(d, right + p * stride + k));
    }
    hn::Store(CountBits<kPlanes>(different), d, costs + k);
  }
}

// Costs of a pixel whose disparities all stay inside the right image. costs: `range` aligned bytes,
// a multiple of the lanes.
template <int kPlanes>
HWY_INLINE void InnerPixelCosts(const SweepFrame& frame, const std::uint8_t* left_row,
                                const std::uint8_t* right_row, int x, int range,
                                std::uint8_t* costs) {
  const std::size_t stride = censusStride(frame.width);
  const std::uint8_t* left = left_row + kCensusMargin + x;
  const std::uint8_t* right =
      right_row + kCensusMargin + (frame.width - 1 - x + frame.min_disparity);
  HammingDistances<kPlanes>(left, right, stride, 0, range, costs);
}

// Costs of any pixel: the largest where x - d leaves the image, 255 from `range` on. costs:
// padded_range aligned bytes.
HWY_INLINE void PixelCosts(const SweepFrame& frame, const std::uint8_t* left_row,
                           const std::uint8_t* right_row, int x, std::uint8_t* costs) {
  const hn::ScalableTag<std::uint8_t> d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const PathLayout& layout = frame.layout;
  const std::size_t stride = censusStride(frame.width);
  const std::uint8_t* left = left_row + kCensusMargin + x;
  // In the mirrored row, disparity index k stands k bytes further.
  const std::ptrdiff_t column = frame.width - 1 - x + frame.min_disparity;
  const int begin = static_cast<int>(std::clamp<std::ptrdiff_t>(-column, 0, layout.range));
  const int end =
      static_cast<int>(std::clamp<std::ptrdiff_t>(frame.width - column, begin, layout.range));
  const int first = begin / lanes * lanes;
  if (begin < end) {
    const std::uint8_t* right = right_row + kCensusMargin + column;
    switch (frame.window) {
      case CensusWindow::k5x5:
        HammingDistances<3>(left, right, stride, first, end, costs);
        break;
      case CensusWindow::k7x7:
        HammingDistances<6>(left, right, stride, first, end, costs);
        break;
      case CensusWindow::k9x7:
        HammingDistances<8>(left, right, stride, first, end, costs);
        break;
    }
  }
  if (begin > 0 || end < layout.range) {
    const int largest = static_cast<int>(frame.window);
    std::memset(costs, largest, begin);
    std::memset(costs + end, largest, layout.range - end);
  }
  if (layout.padded_range > layout.range) {
    std::memset(costs + layout.range, 255, layout.padded_range - layout.range);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace adaptive_grid_stereo
HWY_AFTER_NAMESPACE();

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_MATCHING_COST_INL_H
