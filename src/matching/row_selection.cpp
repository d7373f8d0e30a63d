#include "src/matching/row_selection.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "adaptive_grid_stereo/matching/stereo_matcher.h"

// Plain loops, which the compiler turns into each target's vectors.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/matching/row_selection.cpp"
#include "src/matching/simd-inl.h"
//
#include "src/matching/repeat-inl.h"

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

// What the winners' row says of a pixel's winner.
struct Winner {
  std::int32_t index, sum;  // of any
  std::int32_t disparity;   // of one that is unique, else kInvalidDisparity
  std::int32_t none;        // -1 if there is no winner, else 0
};

// Masks instead of branches, which compilers would not turn into vectors.
HWY_INLINE Winner ReadWinner(std::uint32_t found, std::uint32_t odd, std::uint32_t even, int shift,
                             int subpixel) {
  const int sum = static_cast<int>(highHalf(found));
  const int place = static_cast<int>(lowHalf(found & ~kNotUnique));
  // Of even and odd sums that are equal, the even one wins.
  const int is_odd = static_cast<int>(lowHalf(even)) != sum;
  const std::uint32_t beside = odd ^ ((odd ^ even) & static_cast<std::uint32_t>(-is_odd));
  const int b = static_cast<int>(lowHalf(beside)), a = static_cast<int>(highHalf(beside));
  const int has_offset = subpixel & -((b != kNoSum) & (a != kNoSum) & (b + a > 2 * sum));
  const int index = 2 * place + is_odd;
  const int value = index * kDisparityScale + (SubpixelOffset(b, sum, a) & has_offset);
  const int none = -static_cast<int>(sum >= sumLimit(shift));
  const int invalid = -static_cast<int>((found & kNotUnique) != 0) | none;
  return {index, sum, (value & ~invalid) | (kInvalidDisparity & invalid), none};
}

// Disparities of the unique winners, whether the right image agrees or not.
HWY_NOINLINE HWY_ATTR void FindDisparities(const WinnerRow& winners,
                                           const std::uint8_t* __restrict shift, int width,
                                           int subpixel, std::int16_t* __restrict disparity) {
  const std::uint32_t* __restrict found = winners.found;
  const std::uint32_t* __restrict odd = winners.odd;
  const std::uint32_t* __restrict even = winners.even;
  for (int x = 0; x < width; ++x) {
    const Winner winner = ReadWinner(found[x], odd[x], even[x], shift[x], subpixel);
    disparity[x] = static_cast<std::int16_t>(winner.disparity);
  }
}

// The same; and what each winner claims: which right pixel, `nowhere` if there is no winner, and by
// what. And where the right image is asked: at that pixel and at the one to its right, or else to
// its left, where the winner's neighbour on the side of its sub-pixel disparity would be seen;
// `questions` has the left one of the two.
HWY_NOINLINE HWY_ATTR void FindClaims(const WinnerRow& winners,
                                      const std::uint8_t* __restrict shift, int width, int subpixel,
                                      int min_disparity, std::int32_t nowhere,
                                      std::int32_t* __restrict place,
                                      std::int32_t* __restrict claim,
                                      std::int32_t* __restrict question,
                                      std::int16_t* __restrict disparity) {
  const std::uint32_t* __restrict found = winners.found;
  const std::uint32_t* __restrict odd = winners.odd;
  const std::uint32_t* __restrict even = winners.even;
  for (int x = 0; x < width; ++x) {
    const Winner winner = ReadWinner(found[x], odd[x], even[x], shift[x], subpixel);
    const std::int32_t none = winner.none;
    const std::int32_t right = ((x - min_disparity - winner.index) & ~none) | (nowhere & none);
    place[x] = right;
    claim[x] = winner.sum << shift[x] << kIndexBits | winner.index;
    question[x] = right - (winner.disparity > winner.index * kDisparityScale);
    disparity[x] = static_cast<std::int16_t>(winner.disparity);
  }
}

// Calls f(x) for x = 0 .. count - 1. What goes number by number, compilers would not unroll.
template <class F>
HWY_INLINE void ForEach(int count, const F& f) {
  int x = 0;
  for (; x + 4 <= count; x += 4) Repeat<4>([&](auto i) AGS_LAMBDA { f(x + i); });
  for (; x < count; ++x) f(x);
}

// The left pixels' claims meet: a right pixel keeps the smallest one.
HWY_INLINE void KeepSmallestClaims(const std::int32_t* __restrict place,
                                   const std::int32_t* __restrict claim, int width,
                                   std::int32_t* right) {
  ForEach(width, [=](int x) AGS_LAMBDA {
    std::int32_t* kept = right + place[x];
    *kept = std::min(*kept, claim[x]);
  });
}

// The indices at two right pixels side by side, of which question[x] is the first, in halves: the
// first one's low, as the CPUs that this is built for have it.
HWY_INLINE void Ask(const std::uint16_t* right_index, const std::int32_t* __restrict question,
                    int width, std::uint32_t* __restrict answer) {
  ForEach(width, [=](int x) AGS_LAMBDA {
    std::uint32_t both;
    std::memcpy(&both, right_index + question[x], sizeof(both));
    asm("" : "+r"(both));  // or else compilers gather vectors number by number
    answer[x] = both;
  });
}

// Drops winners that the right image contradicts, in both of the places where it was asked. (Where
// there is no winner, the claim's index means nothing; the value is invalid and stays so.)
HWY_ATTR void DropInconsistent(int width, unsigned most, const std::int32_t* __restrict claim,
                               const std::uint32_t* __restrict answer,
                               std::int16_t* __restrict value) {
  for (int x = 0; x < width; ++x) {
    // What the winner itself, or its neighbour, would have as index there.
    const int index = claim[x] & kIndexMask, offset = value[x] - index * kDisparityScale;
    const int left_k = index + (offset > 0), right_k = left_k - 1;
    const unsigned left = lowHalf(answer[x]) - static_cast<unsigned>(left_k);
    const unsigned right = highHalf(answer[x]) - static_cast<unsigned>(right_k);
    const int keep = -((left + most <= 2 * most) | ((right + most <= 2 * most) & (offset != 0)));
    value[x] = static_cast<std::int16_t>((value[x] & keep) | (kInvalidDisparity & ~keep));
  }
}

// With the left-right check. Of several winners that claim one right pixel the smallest sum has it,
// then the smallest disparity.
HWY_ATTR void SelectConsistent(const WinnerRow& winners, const std::uint8_t* shifts, int width,
                               int subpixel, const MatcherConfig& config, RowBuffers* buffers,
                               std::int16_t* disparity) {
  // One pixel more on either side lets a neighbouring disparity be looked up without asking; one
  // beyond takes the claims of those that have none.
  const std::int32_t nowhere = width + 1;
  const int right_size = width + 4;
  buffers->right.resize(right_size);
  buffers->right_indices.resize(right_size);
  for (auto* row : {&buffers->places, &buffers->claims, &buffers->questions}) row->resize(width);
  buffers->answers.resize(width);
  std::int32_t* claims = buffers->claims.data();
  FindClaims(winners, shifts, width, subpixel, config.min_disparity, nowhere,
             buffers->places.data(), claims, buffers->questions.data(), disparity);
  std::int32_t* right = buffers->right.data();
  std::uint16_t* right_index = buffers->right_indices.data();
  // Not vector::assign(): its code is whichever library's the loader finds first, without vectors.
  std::fill_n(right, right_size, kNoClaim);
  KeepSmallestClaims(buffers->places.data(), claims, width, right + 1);
  for (int x = 0; x < right_size; ++x) {
    right_index[x] = static_cast<std::uint16_t>(right[x] & kIndexMask);
  }
  Ask(right_index + 1, buffers->questions.data(), width, buffers->answers.data());
  const int most = std::min(config.disp12_max_diff, kLargestDifference);
  DropInconsistent(width, static_cast<unsigned>(most), claims, buffers->answers.data(), disparity);
}

HWY_ATTR void SelectRow(const WinnerRow& winners, const std::uint8_t* shifts, int width,
                        const MatcherConfig& config, RowBuffers* buffers, std::int16_t* disparity) {
  const int subpixel = config.subpixel ? -1 : 0;
  if (config.disp12_max_diff < 0)
    return FindDisparities(winners, shifts, width, subpixel, disparity);
  SelectConsistent(winners, shifts, width, subpixel, config, buffers, disparity);
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
