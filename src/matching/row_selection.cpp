#include "src/matching/row_selection.h"

#include <algorithm>
#include <limits>

#include "adaptive_grid_stereo/matching/stereo_matcher.h"

namespace adaptive_grid_stereo {
namespace {

constexpr int kIndexBits = 10;
constexpr int kIndexMask = (1 << kIndexBits) - 1;
/// Its index is farther from every other one than any two disparities are.
constexpr std::int32_t kNoClaim = std::numeric_limits<std::int32_t>::max();
constexpr int kLargestDifference = 511;

// Minimum of the parabola through three sums, in fixed point around 0, rounded half up.
int subpixelOffset(int before, int sum, int after) {
  const int curvature = std::max(1, before + after - 2 * sum);
  // The numerator is brought above zero, so that the division rounds down. Both parts are below
  // 2^24 and the quotient below 64, so the quotient of floats never reaches an integer that the
  // true one does not: and unlike that of integers, it goes by vectors.
  const int shifted =
      (before - after) * kDisparityScale + curvature + 2 * curvature * kDisparityScale;
  return static_cast<int>(static_cast<float>(shifted) / static_cast<float>(2 * curvature)) -
         kDisparityScale;
}

// Disparities of the unique winners, whether the right image agrees or not.
void interpolateRow(const WinnerRow& winners, int width, bool subpixel, std::int16_t* disparity) {
  const std::uint16_t* __restrict index = winners.index;
  const std::uint16_t* __restrict sum = winners.sum;
  const std::uint16_t* __restrict before = winners.before;
  const std::uint16_t* __restrict after = winners.after;
  std::int16_t* __restrict out = disparity;
  const int wanted = subpixel ? -1 : 0;
  // Masks instead of branches, which compilers would not turn into vectors.
  for (int x = 0; x < width; ++x) {
    const int b = before[x], s = sum[x], a = after[x], k = index[x];
    const int has_offset = wanted & -((b != kNoSum) & (a != kNoSum) & (b + a > 2 * s));
    const int value = k * kDisparityScale + (subpixelOffset(b, s, a) & has_offset);
    const int invalid = -(k >> 15);  // kNotUnique, which is set in kNoWinner, too
    out[x] = static_cast<std::int16_t>((value & ~invalid) | (kInvalidDisparity & invalid));
  }
}

// Of several winners that claim one right pixel the smallest sum has it, then the smallest
// disparity.
void claimRow(const WinnerRow& winners, const std::uint8_t* shifts, int width, int min_disparity,
              std::int32_t* right) {
  for (int x = 0; x < width; ++x) {
    if (winners.index[x] == kNoWinner) continue;
    const int k = winners.index[x] & ~kNotUnique;
    std::int32_t& owner = right[x - min_disparity - k];
    owner = std::min(owner, (winners.sum[x] << shifts[x] << kIndexBits) | k);
  }
}

}  // namespace

void selectRow(const WinnerRow& winners, const std::uint8_t* shifts, int width,
               const MatcherConfig& config, RightClaims* claims, std::int16_t* disparity) {
  interpolateRow(winners, width, config.subpixel, disparity);
  if (config.disp12_max_diff < 0) return;
  const int min_disparity = config.min_disparity;
  const unsigned most = static_cast<unsigned>(std::min(config.disp12_max_diff, kLargestDifference));
  // One pixel more on either side lets a neighbouring disparity be looked up without asking.
  claims->sum_and_index.assign(width + 2, kNoClaim);
  std::int32_t* right = claims->sum_and_index.data() + 1;
  claimRow(winners, shifts, width, min_disparity, right);
  const auto consistent = [&](int x, int k) {
    const int difference = (right[x - min_disparity - k] & kIndexMask) - k;
    return static_cast<unsigned>(difference) + most <= 2 * most;
  };
  for (int x = 0; x < width; ++x) {
    const int k = winners.index[x];
    if ((k & kNotUnique) || consistent(x, k)) continue;
    const int lower = disparity[x] >> kDisparityShift;
    const int upper = (disparity[x] + kDisparityScale - 1) >> kDisparityShift;
    if (!consistent(x, lower == k ? upper : lower)) disparity[x] = kInvalidDisparity;
  }
}

}  // namespace adaptive_grid_stereo
