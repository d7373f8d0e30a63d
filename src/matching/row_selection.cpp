#include "src/matching/row_selection.h"

#include <algorithm>
#include <cstdlib>
#include <limits>

#include "adaptive_grid_stereo/matching/stereo_matcher.h"

namespace adaptive_grid_stereo {
namespace {

constexpr std::int32_t kNoClaim = std::numeric_limits<std::int32_t>::max();
constexpr int kIndexBits = 10;

// Minimum of the parabola through three sums, in fixed point around 0, rounded half up.
int subpixelOffset(int before, int sum, int after) {
  const int curvature = before + after - 2 * sum;
  if (curvature <= 0) return 0;
  // The numerator is brought above zero, so that the division rounds down.
  const int shifted =
      (before - after) * kDisparityScale + curvature + 2 * curvature * kDisparityScale;
  return shifted / (2 * curvature) - kDisparityScale;
}

}  // namespace

void selectRow(const Winner* winners, const std::uint8_t* shifts, int width,
               const MatcherConfig& config, RightClaims* claims, std::int16_t* disparity) {
  const bool check = config.disp12_max_diff >= 0;
  const int min_disparity = config.min_disparity;
  const unsigned most = static_cast<unsigned>(std::max(0, config.disp12_max_diff));
  // Of several winners that claim one right pixel the smallest sum has it, then the smallest
  // disparity. One pixel more on either side lets a neighbouring disparity be looked up without
  // asking.
  claims->sum_and_index.assign(width + 2, kNoClaim);
  std::int32_t* right = claims->sum_and_index.data() + 1;
  if (check) {
    for (int x = 0; x < width; ++x) {
      const Winner winner = winners[x];
      if (winner.index == kNoWinner) continue;
      const int k = winner.index & ~kNotUnique;
      const std::int32_t claim = (winner.sum << shifts[x] << kIndexBits) | k;
      std::int32_t& owner = right[x - min_disparity - k];
      owner = std::min(owner, claim);
    }
  }
  const auto consistent = [&](int x, int k) {
    const std::int32_t claim = right[x - min_disparity - k];
    const int difference = (claim & ((1 << kIndexBits) - 1)) - k;
    return claim != kNoClaim && static_cast<unsigned>(std::abs(difference)) <= most;
  };
  for (int x = 0; x < width; ++x) {
    const Winner winner = winners[x];
    disparity[x] = kInvalidDisparity;
    if (winner.index & kNotUnique) continue;  // kNoWinner has this bit, too
    const int k = winner.index;
    int value = k * kDisparityScale;
    if (config.subpixel && winner.before != kNoSum && winner.after != kNoSum) {
      value += subpixelOffset(winner.before, winner.sum, winner.after);
    }
    if (check && !consistent(x, k)) {
      const int lower = value >> kDisparityShift;
      const int upper = (value + kDisparityScale - 1) >> kDisparityShift;
      if (!consistent(x, lower == k ? upper : lower)) continue;
    }
    disparity[x] = static_cast<std::int16_t>(value);
  }
}

}  // namespace adaptive_grid_stereo
