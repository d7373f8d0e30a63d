// Winner-takes-all and uniqueness of one pixel. Included once per SIMD target.
#if defined(ADAPTIVE_GRID_STEREO_SRC_MATCHING_DISPARITY_SELECTION_INL_H) == \
    defined(HWY_TARGET_TOGGLE)
#ifdef ADAPTIVE_GRID_STEREO_SRC_MATCHING_DISPARITY_SELECTION_INL_H
#undef ADAPTIVE_GRID_STEREO_SRC_MATCHING_DISPARITY_SELECTION_INL_H
#else
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_DISPARITY_SELECTION_INL_H
#endif

#include <algorithm>

#include "src/matching/path_aggregation-inl.h"
#include "src/matching/sweep.h"

HWY_BEFORE_NAMESPACE();
namespace adaptive_grid_stereo {
namespace HWY_NAMESPACE {
namespace hn = AGS_SIMD;

// The sums of a pixel lie in blocks of as many disparities as a vector has bytes: first those of
// the even disparities of the block, then those of the odd ones. This is where the sum of index k
// stands.
HWY_INLINE int PlaceOfSum(int k) {
  const int lanes = static_cast<int>(hn::Lanes(D8()));
  return (k & ~(lanes - 1)) + (k & 1) * (lanes / 2) + (k & (lanes - 1)) / 2;
}

// Finds the first smallest sum while they pass.
//
// Sums of 16 paths stay below 4096, so four bits are free for the number of the block: one minimum
// per lane then finds both. A sum of kNoSum loses against every other.
struct WinnerSearch {
  V16 even, odd;
};

constexpr int kSearchBlocks = 16;

HWY_INLINE WinnerSearch StartSearch() {
  const V16 none = hn::Set(D16(), std::uint16_t{0xFFFF});
  return {none, none};
}

HWY_INLINE void AddToSearch(const ByteSums& sums, int block, WinnerSearch* search) {
  const V16 number = hn::Set(D16(), static_cast<std::uint16_t>(block));
  search->even = hn::Min(search->even, hn::Or(hn::ShiftLeft<4>(sums.even), number));
  search->odd = hn::Min(search->odd, hn::Or(hn::ShiftLeft<4>(sums.odd), number));
}

// Minimum over the blocks of 8 sums.
HWY_INLINE auto FoldSums(V16 v) {
#if HWY_TARGET == HWY_AVX2
  return hn::Min(hn::LowerHalf(v), hn::UpperHalf(hn::Half<D16>(), v));
#elif HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
  const auto half = hn::Min(hn::LowerHalf(v), hn::UpperHalf(hn::Half<D16>(), v));
  return hn::Min(hn::LowerHalf(half), hn::UpperHalf(hn::Half<hn::Half<D16> >(), half));
#else
  return v;
#endif
}

// The winning index among the searched sums, which lie at `sums`; tells its sum.
HWY_INLINE int EndSearch(const WinnerSearch& search, const std::uint16_t* sums, int* sum) {
  const D16 d;
  const hn::Full128<std::uint16_t> d128;
  const V16 keys = hn::Min(search.even, search.odd);
  const std::uint16_t key = hn::GetLane(hn::MinOfLanes(d128, FoldSums(keys)));
  const int lane = static_cast<int>(hn::FindKnownFirstTrue(d, hn::Eq(keys, hn::Set(d, key))));
  const int block = (key & 15) * static_cast<int>(hn::Lanes(D8()));
  *sum = key >> 4;
  return block + 2 * lane + (sums[block + lane] != *sum);
}

// Indices of the even disparities of a block; the odd ones are one larger.
HWY_INLINE V16 EvenIndices(int block_begin) {
  const D16 d;
  alignas(64) static constexpr std::uint16_t kEven[32] = {
      0,  2,  4,  6,  8,  10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30,
      32, 34, 36, 38, 40, 42, 44, 46, 48, 50, 52, 54, 56, 58, 60, 62};
  return hn::Add(hn::Load(d, kEven), hn::Set(d, static_cast<std::uint16_t>(block_begin)));
}

// Sums of a block beginning at disparity index `at` become kNoSum from index `range` on.
HWY_INLINE void DropSumsBeyond(int range, int at, ByteSums* sums) {
  const D16 d;
  if (at + static_cast<int>(hn::Lanes(D8())) <= range) return;
  const V16 last = hn::Set(d, static_cast<std::uint16_t>(range - 1)), none = hn::Set(d, kNoSum);
  const V16 even = EvenIndices(at), odd = hn::Add(even, hn::Set(d, std::uint16_t{1}));
  sums->even = hn::IfThenElse(hn::Eq(hn::Min(even, last), even), sums->even, none);
  sums->odd = hn::IfThenElse(hn::Eq(hn::Min(odd, last), odd), sums->odd, none);
}

// The winner among the candidates [begin, end) of any number of sums in memory; the other sums
// become kNoSum.
HWY_INLINE int SearchCandidates(std::uint16_t* sums, int count, int begin, int end) {
  const D16 d;
  const int lanes = static_cast<int>(hn::Lanes(D8()));
  const V16 first = hn::Set(d, static_cast<std::uint16_t>(begin));
  const V16 last = hn::Set(d, static_cast<std::uint16_t>(end - 1));
  const V16 none = hn::Set(d, kNoSum);
  const V16 one = hn::Set(d, std::uint16_t{1});
  // kNoSum would lose its upper bits.
  const V16 most = hn::Set(d, std::uint16_t{0x0FFF});
  const auto keep = [&](V16 sum, V16 index) AGS_LAMBDA {
    return hn::IfThenElse(hn::Eq(hn::Min(hn::Max(index, first), last), index), sum, none);
  };
  int best = 0, best_sum = 0x10000;
  for (int group = 0; group < count; group += kSearchBlocks * lanes) {
    WinnerSearch search = StartSearch();
    for (int block = 0; block < kSearchBlocks && group + block * lanes < count; ++block) {
      const int at = group + block * lanes;
      const V16 index = EvenIndices(at);
      const V16 even = keep(hn::Load(d, sums + at), index);
      const V16 odd = keep(hn::Load(d, sums + at + lanes / 2), hn::Add(index, one));
      hn::Store(even, d, sums + at);
      hn::Store(odd, d, sums + at + lanes / 2);
      AddToSearch({hn::Min(even, most), hn::Min(odd, most)}, block, &search);
    }
    int sum = 0;
    const int winner = group + EndSearch(search, sums + group, &sum);
    if (sum < best_sum) {
      best_sum = sum;
      best = winner;
    }
  }
  return best;
}

// Whether a sum other than the winner's and its neighbours' is below the threshold. Overwrites
// those three.
HWY_INLINE bool HasRival(std::uint16_t* sums, int count, int winner, std::uint32_t threshold) {
  const D16 d;
  for (int k = std::max(0, winner - 1); k <= std::min(count - 1, winner + 1); ++k) {
    sums[PlaceOfSum(k)] = kNoSum;
  }
  const V16 limit =
      hn::Set(d, static_cast<std::uint16_t>(std::min<std::uint32_t>(threshold, 0xFFFF)));
  V16 below = hn::Zero(d);
  for (int k = 0; k < count; k += static_cast<int>(hn::Lanes(d))) {
    below = hn::Or(below, hn::SaturatedSub(limit, hn::Load(d, sums + k)));
  }
  return !hn::AllTrue(d, hn::Eq(below, hn::Zero(d)));
}

// The winner with its neighbours among the candidates [begin, end).
HWY_INLINE Winner MakeWinner(const SweepFrame& frame, std::uint16_t* sums, int count, int index,
                             int sum, int begin, int end) {
  Winner winner;
  winner.index = static_cast<std::uint16_t>(index);
  winner.sum = static_cast<std::uint16_t>(sum);
  winner.before = index > begin ? sums[PlaceOfSum(index - 1)] : kNoSum;
  winner.after = index + 1 < end ? sums[PlaceOfSum(index + 1)] : kNoSum;
  if (frame.uniqueness_factor > 0) {
    const std::uint32_t threshold =
        static_cast<std::uint32_t>(sum) * static_cast<std::uint32_t>(frame.uniqueness_factor) >> 12;
    if (HasRival(sums, count, index, threshold)) winner.index |= kNotUnique;
  }
  return winner;
}

// Winner of a pixel where not every disparity stays inside the right image, or not every sum is a
// disparity's.
HWY_INLINE Winner SelectAmongCandidates(const SweepFrame& frame, std::uint16_t* sums, int x) {
  const PathLayout& layout = frame.layout;
  const int column = x - frame.min_disparity;
  const int begin = std::clamp(column - (frame.width - 1), 0, layout.range);
  const int end = std::clamp(column + 1, begin, layout.range);
  if (begin >= end) return {kNoWinner, kNoSum, kNoSum, kNoSum};
  const int winner = SearchCandidates(sums, layout.padded_range, begin, end);
  return MakeWinner(frame, sums, layout.padded_range, winner, sums[PlaceOfSum(winner)], begin, end);
}

}  // namespace HWY_NAMESPACE
}  // namespace adaptive_grid_stereo
HWY_AFTER_NAMESPACE();

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_DISPARITY_SELECTION_INL_H
