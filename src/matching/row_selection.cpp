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

void selectRow(const WinnerRow& winners, const std::uint8_t* shifts, int width,
               const MatcherConfig& config, RightClaims* claims, std::int16_t* disparity) {
  const bool check = config.disp12_max_diff >= 0;
  // Of several winners that claim one right pixel the smallest sum has it, then the smallest
  // disparity.
  claims->sum_and_index.resize(width);
  std::int32_t* right = claims->sum_and_index.data();
  if (check) {
    std::fill(right, right + width, kNoClaim);
    for (int x = 0; x < width; ++x) {
      if (winners.index[x] == kNoWinner) continue;
      const int k = winners.index[x] & ~kNotUnique;
      const std::int32_t claim = (winners.sum[x] << shifts[x] << kIndexBits) | k;
      std::int32_t& owner = right[x - config.min_disparity - k];
      owner = std::min(owner, claim);
    }
  }
  const auto consistent = [&](int x, int k) {
    const int u = x - config.min_disparity - k;
    if (u < 0 || u >= width || right[u] == kNoClaim) return false;
    return std::abs((right[u] & ((1 << kIndexBits) - 1)) - k) <= config.disp12_max_diff;
  };
  for (int x = 0; x < width; ++x) {
    disparity[x] = kInvalidDisparity;
    if (winners.index[x] & kNotUnique) continue;  // kNoWinner has this bit, too
    const int k = winners.index[x];
    int value = k * kDisparityScale;
    if (config.subpixel && winners.before[x] != kNoSum && winners.after[x] != kNoSum) {
      value += subpixelOffset(winners.before[x], winners.sum[x], winners.after[x]);
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
