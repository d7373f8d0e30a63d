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

// Disparities of the unique winners, whether the right image agrees or not; and the indices of all.
HWY_ATTR void InterpolateRow(const WinnerRow& winners, int width, bool subpixel,
                             std::int32_t* indices, std::int16_t* disparity) {
  const std::uint32_t* __restrict found = winners.found;
  const std::uint32_t* __restrict odd = winners.odd;
  const std::uint32_t* __restrict even = winners.even;
  std::int32_t* __restrict index = indices;
  std::int16_t* __restrict out = disparity;
  const int wanted = subpixel ? -1 : 0;
  // Masks instead of branches, which compilers would not turn into vectors.
  for (int x = 0; x < width; ++x) {
    const int s = static_cast<int>(highHalf(found[x]));
    const int place = static_cast<int>(lowHalf(found[x] & ~kNotUnique));
    // Of even and odd sums that are equal, the even one wins.
    const int is_odd = static_cast<int>(lowHalf(even[x])) != s;
    const std::uint32_t beside =
        odd[x] ^ ((odd[x] ^ even[x]) & static_cast<std::uint32_t>(-is_odd));
    const int b = static_cast<int>(lowHalf(beside)), a = static_cast<int>(highHalf(beside));
    const int has_offset = wanted & -((b != kNoSum) & (a != kNoSum) & (b + a > 2 * s));
    const int k = 2 * place + is_odd;
    const int value = k * kDisparityScale + (SubpixelOffset(b, s, a) & has_offset);
    const int invalid = -static_cast<int>(found[x] >> 15 & 1);  // kNotUnique; in kNoWinner, too
    index[x] = k;
    out[x] = static_cast<std::int16_t>((value & ~invalid) | (kInvalidDisparity & invalid));
  }
}

// What each winner claims: which right pixel, `nowhere` if there is no winner, and by what. And
// where the right image is asked: at that pixel and at the one to its right, or else to its left,
// where the winner's neighbour on the side of its sub-pixel disparity would be seen; `questions`
// has the left one of the two.
HWY_NOINLINE HWY_ATTR void FindClaims(
    const std::uint32_t* __restrict found, const std::uint8_t* __restrict shift,
    const std::int32_t* __restrict index, const std::int16_t* __restrict disparity, int width,
    int min_disparity, std::int32_t nowhere, std::int32_t* __restrict place,
    std::int32_t* __restrict claim, std::int32_t* __restrict question) {
  for (int x = 0; x < width; ++x) {
    const std::int32_t k = index[x], sum = static_cast<std::int32_t>(highHalf(found[x]));
    const std::int32_t none = -static_cast<std::int32_t>(sum == kNoSum);
    const std::int32_t right = ((x - min_disparity - k) & ~none) | (nowhere & none);
    place[x] = right;
    claim[x] = sum << shift[x] << kIndexBits | k;
    question[x] = right - (disparity[x] > k * kDisparityScale);
  }
}

// Drops winners that the right image contradicts, in both of the places where it was asked.
HWY_ATTR void DropInconsistent(int width, unsigned most, const RowBuffers& buffers,
                               std::int16_t* disparity) {
  const std::int32_t* __restrict index = buffers.indices.data();
  const std::int32_t* __restrict place = buffers.places.data();
  const std::int32_t* __restrict question = buffers.questions.data();
  const std::int32_t* __restrict answer = buffers.answers.data();
  std::int16_t* __restrict value = disparity;
  for (int x = 0; x < width; ++x) {
    // What the winner itself, or its neighbour, would have as index there.
    const std::int32_t left_k = index[x] + place[x] - question[x], right_k = left_k - 1;
    const unsigned left = static_cast<unsigned>((answer[2 * x] & kIndexMask) - left_k);
    const unsigned right = static_cast<unsigned>((answer[2 * x + 1] & kIndexMask) - right_k);
    const int has_side = value[x] != index[x] * kDisparityScale;
    const int keep = -((left + most <= 2 * most) | ((right + most <= 2 * most) & has_side));
    value[x] = static_cast<std::int16_t>((value[x] & keep) | (kInvalidDisparity & ~keep));
  }
}

// The left-right check. Of several winners that claim one right pixel the smallest sum has it, then
// the smallest disparity.
HWY_ATTR void CheckRow(const std::uint32_t* winners, const std::uint8_t* shifts, int width,
                       const MatcherConfig& config, RowBuffers* buffers, std::int16_t* disparity) {
  // One pixel more on either side lets a neighbouring disparity be looked up without asking; one
  // beyond takes the claims of those that have none.
  const std::int32_t nowhere = width + 1;
  buffers->right.resize(width + 4);
  // Not vector::assign(): its code is whichever library's the loader finds first, without vectors.
  std::fill_n(buffers->right.data(), width + 4, kNoClaim);
  for (auto* row : {&buffers->places, &buffers->claims, &buffers->questions}) row->resize(width);
  buffers->answers.resize(2 * static_cast<std::size_t>(width));
  FindClaims(winners, shifts, buffers->indices.data(), disparity, width, config.min_disparity,
             nowhere, buffers->places.data(), buffers->claims.data(), buffers->questions.data());
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
  DropInconsistent(width, static_cast<unsigned>(most), *buffers, disparity);
}

HWY_ATTR void SelectRow(const WinnerRow& winners, const std::uint8_t* shifts, int width,
                        const MatcherConfig& config, RowBuffers* buffers, std::int16_t* disparity) {
  buffers->indices.resize(width);
  InterpolateRow(winners, width, config.subpixel, buffers->indices.data(), disparity);
  if (config.disp12_max_diff < 0) return;
  CheckRow(winners.found, shifts, width, config, buffers, disparity);
}

}  // namespace HWY_NAMESPACE
}  // namespace adaptive_grid_stereo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace adaptive_grid_stereo {
HWY_EXPORT(SelectRow);

void selectRow(const WinnerRow& winners, const std::uint8_t* shifts, int width,
               const MatcherConfig& config, RowBuffers* buffers, std::int16_t* disparity) {
  HWY_DYNAMIC_DISPATCH(SelectRow)(winners, shifts, width, config, buffers, disparity);
}

}  // namespace adaptive_grid_stereo
#endif  // HWY_ONCE
