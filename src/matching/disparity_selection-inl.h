// Winner-takes-all and uniqueness of one pixel. Included once per SIMD target.
#if defined(ADAPTIVE_GRID_STEREO_SRC_MATCHING_DISPARITY_SELECTION_INL_H) == \
    defined(HWY_TARGET_TOGGLE)
#ifdef ADAPTIVE_GRID_STEREO_SRC_MATCHING_DISPARITY_SELECTION_INL_H
#undef ADAPTIVE_GRID_STEREO_SRC_MATCHING_DISPARITY_SELECTION_INL_H
#else
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_DISPARITY_SELECTION_INL_H
#endif

#include <algorithm>

#include "src/matching/sweep.h"

HWY_BEFORE_NAMESPACE();
namespace adaptive_grid_stereo {
namespace HWY_NAMESPACE {
namespace hn = AGS_SIMD;

// Index of the first smallest sum among `count` (a multiple of the lanes) aligned sums.
//
// Sums of 16 paths stay below 4096, so four bits are free for the number of the vector within a
// group of 16: one minimum then finds both. Sums of kNoSum lose against every other.
HWY_INLINE int SmallestIndex(const std::uint16_t* sums, int count) {
  const hn::ScalableTag<std::uint16_t> d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  int best_key = 0xFFFF, best = 0;
  for (int group = 0; group < count; group += 16 * lanes) {
    const int group_end = std::min(count, group + 16 * lanes);
    auto keys = hn::Set(d, std::uint16_t{0xFFFF});
    auto number = hn::Zero(d);
    const auto one = hn::Set(d, std::uint16_t{1});
    for (int k = group; k < group_end; k += lanes) {
      const auto sum = hn::Load(d, sums + k);
      // A saturating shift: kNoSum must stay the largest.
      const auto shifted = hn::ShiftLeft<4>(hn::Min(sum, hn::Set(d, std::uint16_t{0x0FFF})));
      keys = hn::Min(keys, hn::Or(shifted, number));
      number = hn::Add(number, one);
    }
    const auto smallest = hn::MinOfLanes(d, keys);
    const int key = hn::GetLane(smallest);
    if ((key >> 4) < (best_key >> 4)) {
      best_key = key;
      best = group + (key & 15) * lanes +
             static_cast<int>(hn::FindFirstTrue(d, hn::Eq(keys, smallest)));
    }
  }
  return best;
}

// Whether a sum other than the winner's and its neighbours' is below the threshold. Overwrites
// those three.
HWY_INLINE bool HasRival(std::uint16_t* sums, int count, int winner, std::uint32_t threshold) {
  const hn::ScalableTag<std::uint16_t> d;
  for (int k = std::max(0, winner - 1); k <= std::min(count - 1, winner + 1); ++k) {
    sums[k] = kNoSum;
  }
  const auto limit =
      hn::Set(d, static_cast<std::uint16_t>(std::min<std::uint32_t>(threshold, 0xFFFF)));
  auto below = hn::Zero(d);
  for (int k = 0; k < count; k += static_cast<int>(hn::Lanes(d))) {
    below = hn::Or(below, hn::SaturatedSub(limit, hn::Load(d, sums + k)));
  }
  return !hn::AllTrue(d, hn::Eq(below, hn::Zero(d)));
}

// sums: padded_range aligned sums of pixel x, of which [range, padded_range) may hold anything.
HWY_INLINE void SelectWinner(const SweepFrame& frame, std::uint16_t* sums, int x,
                             const WinnerRow& winners) {
  const PathLayout& layout = frame.layout;
  // Candidates are those disparities that x - d keeps inside the right image.
  const int column = x - frame.min_disparity;
  const int begin = std::clamp(column - (frame.width - 1), 0, layout.range);
  const int end = std::clamp(column + 1, begin, layout.range);
  if (begin > 0) std::fill(sums, sums + begin, kNoSum);
  if (end < layout.padded_range) std::fill(sums + end, sums + layout.padded_range, kNoSum);
  if (begin >= end) {
    winners.index[x] = kNoWinner;
    return;
  }
  const int winner = SmallestIndex(sums, layout.padded_range);
  const std::uint16_t sum = sums[winner];
  winners.sum[x] = sum;
  winners.before[x] = winner > begin ? sums[winner - 1] : kNoSum;
  winners.after[x] = winner + 1 < end ? sums[winner + 1] : kNoSum;
  std::uint16_t index = static_cast<std::uint16_t>(winner);
  if (frame.uniqueness_factor > 0) {
    const std::uint32_t threshold =
        static_cast<std::uint32_t>(sum) * static_cast<std::uint32_t>(frame.uniqueness_factor) >> 12;
    if (HasRival(sums, layout.padded_range, winner, threshold)) index |= kNotUnique;
  }
  winners.index[x] = index;
}

}  // namespace HWY_NAMESPACE
}  // namespace adaptive_grid_stereo
HWY_AFTER_NAMESPACE();

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_DISPARITY_SELECTION_INL_H
