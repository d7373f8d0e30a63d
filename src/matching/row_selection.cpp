#include "src/matching/row_selection.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "adaptive_grid_stereo/matching/stereo_matcher.h"

// Plain loops, which the compiler turns into each target's vectors.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/matching/row_selection.cpp"
#include "src/matching/simd-inl.h"

#if !defined(AGS_ROW_SELECTION_SHARED)
#define AGS_ROW_SELECTION_SHARED
namespace adaptive_grid_stereo {

constexpr int kIndexBits = 10;
constexpr std::int32_t kIndexMask = (1 << kIndexBits) - 1;
/// Its index is farther from every other one than any two disparities are.
constexpr std::int32_t kNoClaim = std::numeric_limits<std::int32_t>::max();
constexpr int kLargestDifference = 511;

}  // namespace adaptive_grid_stereo
#endif  // AGS_ROW_SELECTION_SHARED

HWY_BEFORE_NAMESPACE();
namespace adaptive_grid_stereo {
namespace HWY_NAMESPACE {

HWY_INLINE int IndexOf(const Winner& winner) { return static_cast<int>(lowHalf(winner.found)); }
HWY_INLINE int SumOf(const Winner& winner) { return static_cast<int>(highHalf(winner.found)); }

// Minimum of the parabola through three sums, in fixed point around 0, rounded half up.
HWY_INLINE int SubpixelOffset(int before, int sum, int after) {
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
HWY_ATTR void InterpolateRow(const Winner* winners, int width, bool subpixel,
                             std::int16_t* disparity) {
  const Winner* __restrict winner = winners;
  std::int16_t* __restrict out = disparity;
  const int wanted = subpixel ? -1 : 0;
  // Masks instead of branches, which compilers would not turn into vectors.
  for (int x = 0; x < width; ++x) {
    const int k = IndexOf(winner[x]), s = SumOf(winner[x]);
    const int b = static_cast<int>(lowHalf(winner[x].beside));
    const int a = static_cast<int>(highHalf(winner[x].beside));
    const int has_offset = wanted & -((b != kNoSum) & (a != kNoSum) & (b + a > 2 * s));
    const int value = k * kDisparityScale + (SubpixelOffset(b, s, a) & has_offset);
    const int invalid = -(k >> 15);  // kNotUnique, which is set in kNoWinner, too
    out[x] = static_cast<std::int16_t>((value & ~invalid) | (kInvalidDisparity & invalid));
  }
}

// What each winner claims: which right pixel, `nowhere` if there is no winner, and by what. And
// where the right image is asked: at that pixel and at the one to its right, or else to its left,
// where the winner's neighbour on the side of its sub-pixel disparity would be seen; `questions`
// has the left one of the two.
HWY_ATTR void FindClaims(const Winner* winners, const std::uint8_t* shifts,
                         const std::int16_t* disparity, int width, int min_disparity,
                         std::int32_t nowhere, RowBuffers* buffers) {
  const Winner* __restrict winner = winners;
  const std::uint8_t* __restrict shift = shifts;
  const std::int16_t* __restrict value = disparity;
  std::int32_t* __restrict place = buffers->places.data();
  std::int32_t* __restrict claim = buffers->claims.data();
  std::int32_t* __restrict question = buffers->questions.data();
  for (int x = 0; x < width; ++x) {
    const std::int32_t index = IndexOf(winner[x]), k = index & ~static_cast<int>(kNotUnique);
    const std::int32_t none = -static_cast<std::int32_t>(index == static_cast<int>(kNoWinner));
    const std::int32_t right = ((x - min_disparity - k) & ~none) | (nowhere & none);
    place[x] = right;
    claim[x] = SumOf(winner[x]) << shift[x] << kIndexBits | k;
    question[x] = right - (value[x] > k * kDisparityScale);
  }
}

// Drops winners that the right image contradicts, in both of the places where it was asked.
HWY_ATTR void DropInconsistent(const Winner* winners, int width, unsigned most,
                               const RowBuffers& buffers, std::int16_t* disparity) {
  const Winner* __restrict winner = winners;
  const std::int32_t* __restrict place = buffers.places.data();
  const std::int32_t* __restrict question = buffers.questions.data();
  const std::int32_t* __restrict answer = buffers.answers.data();
  std::int16_t* __restrict value = disparity;
  for (int x = 0; x < width; ++x) {
    const std::int32_t k = IndexOf(winner[x]) & ~static_cast<int>(kNotUnique);
    // What the winner itself, or its neighbour, would have as index there.
    const std::int32_t left_k = k + place[x] - question[x], right_k = left_k - 1;
    const unsigned left = static_cast<unsigned>((answer[2 * x] & kIndexMask) - left_k);
    const unsigned right = static_cast<unsigned>((answer[2 * x + 1] & kIndexMask) - right_k);
    const int has_side = value[x] != k * kDisparityScale;
    const int keep = -((left + most <= 2 * most) | ((right + most <= 2 * most) & has_side));
    value[x] = static_cast<std::int16_t>((value[x] & keep) | (kInvalidDisparity & ~keep));
  }
}

// The left-right check. Of several winners that claim one right pixel the smallest sum has it, then
// the smallest disparity.
HWY_ATTR void CheckRow(const Winner* winners, const std::uint8_t* shifts, int width,
                       const MatcherConfig& config, RowBuffers* buffers, std::int16_t* disparity) {
  // One pixel more on either side lets a neighbouring disparity be looked up without asking; one
  // beyond takes the claims of those that have none.
  const std::int32_t nowhere = width + 1;
  buffers->right.assign(width + 4, kNoClaim);
  for (auto* row : {&buffers->places, &buffers->claims, &buffers->questions}) row->resize(width);
  buffers->answers.resize(2 * static_cast<std::size_t>(width));
  FindClaims(winners, shifts, disparity, width, config.min_disparity, nowhere, buffers);
  std::int32_t* right = buffers->right.data() + 1;
  const std::int32_t* place = buffers->places.data();
  const std::int32_t* claim = buffers->claims.data();
  for (int x = 0; x < width; ++x) right[place[x]] = std::min(right[place[x]], claim[x]);
  const std::int32_t* question = buffers->questions.data();
  std::int32_t* answer = buffers->answers.data();
  for (int x = 0; x < width; ++x) {
    std::memcpy(answer + 2 * x, right + question[x], 2 * sizeof(*answer));
  }
  const int most = std::min(config.disp12_max_diff, kLargestDifference);
  DropInconsistent(winners, width, static_cast<unsigned>(most), *buffers, disparity);
}

HWY_ATTR void SelectRow(const Winner* winners, const std::uint8_t* shifts, int width,
                        const MatcherConfig& config, RowBuffers* buffers, std::int16_t* disparity) {
  InterpolateRow(winners, width, config.subpixel, disparity);
  if (config.disp12_max_diff < 0) return;
  CheckRow(winners, shifts, width, config, buffers, disparity);
}

}  // namespace HWY_NAMESPACE
}  // namespace adaptive_grid_stereo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace adaptive_grid_stereo {
HWY_EXPORT(SelectRow);

void selectRow(const Winner* winners, const std::uint8_t* shifts, int width,
               const MatcherConfig& config, RowBuffers* buffers, std::int16_t* disparity) {
  HWY_DYNAMIC_DISPATCH(SelectRow)(winners, shifts, width, config, buffers, disparity);
}

}  // namespace adaptive_grid_stereo
#endif  // HWY_ONCE
