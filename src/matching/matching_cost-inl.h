// Matching costs of one pixel (eq. 4). Included once per SIMD target.
#if defined(ADAPTIVE_GRID_STEREO_SRC_MATCHING_MATCHING_COST_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef ADAPTIVE_GRID_STEREO_SRC_MATCHING_MATCHING_COST_INL_H
#undef ADAPTIVE_GRID_STEREO_SRC_MATCHING_MATCHING_COST_INL_H
#else
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_MATCHING_COST_INL_H
#endif

#include "src/matching/hamming_distance-inl.h"
#include "src/matching/path_aggregation-inl.h"
#include "src/matching/sweep.h"

HWY_BEFORE_NAMESPACE();
namespace adaptive_grid_stereo {
namespace HWY_NAMESPACE {
namespace hn = AGS_SIMD;

// Costs of a vector of disparities of which some may leave the right image: there the largest cost
// stands.
HWY_INLINE V8 BorderCosts(const SweepFrame& frame, const CensusPlaces& at, int k) {
  const D8 d;
  const V8 largest = hn::Set(d, static_cast<std::uint8_t>(frame.window));
  const std::ptrdiff_t first = at.column + k;
  // Unsigned, so that one comparison tells both sides.
  const std::size_t others = hn::Lanes(d) - 1, last = static_cast<std::size_t>(first) + others;
  if (last >= static_cast<std::size_t>(frame.width) + others) return largest;
  V8 costs;
  HammingDistances<1>(frame.window, at, k, &costs);
  return hn::Min(hn::Or(costs, hn::LoadU(d, frame.outside + first)), largest);
}

}  // namespace HWY_NAMESPACE
}  // namespace adaptive_grid_stereo
HWY_AFTER_NAMESPACE();

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_MATCHING_COST_INL_H
