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

// The sums of a pixel lie in blocks of as many disparities as a vector has bytes: first those of the even
// disparities of the block, then those of the odd ones. This is where the sum of index k stands.
HWY_INLINE int PlaceOfSum(int k) {
  const int lanes = static_cast<int>(hn::Lanes(D8()));
  return (k & ~(lanes - 1)) + (k & 1) * (lanes / 2) + (k & (lanes - 1)) / 2;
}

// Finds the first smallest sum while they pass.
//
// Sums of 16 paths stay below 4096, so four bits are free for the number of the block: one minimum per lane
// then finds both. A sum of kNoSum loses against every other.
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

// The winning index, and its sum in `key`'s upper 12 bits.
HWY_INLINE int EndSearch(const WinnerSearch& search, int* key) {
  const D16 d;
  const V16 smallest = hn::MinOfLanes(d, hn::Min(search.even, search.odd));
  *key = hn::GetLane(smallest);
  const auto even = hn::FindFirstTrue(d, hn::Eq(search.even, smallest));
  const auto odd = hn::FindFirstTrue(d, hn::Eq(search.odd, smallest));
  // -1, for none, becomes the largest unsigned number.
  const unsigned lane = std::min(2 * static_cast<unsigned>(even), 2 * static_cast<unsigned>(odd) + 1);
  // 2 * none + 1 wraps to the largest number again, 2 * none to one below it.
  return (*key & 15) * static_cast<int>(hn::Lanes(D8())) + static_cast<int>(lane);
}

// The same from sums in memory, for any number of blocks.
HWY_INLINE int SearchWinner(const std::uint16_t* sums, int count) {
  const D16 d;
  const int lanes = static_cast<int>(hn::Lanes(D8()));
  int best = 0, best_sum = 0x10000;
  for (int group = 0; group < count; group += kSearchBlocks * lanes) {
    WinnerSearch search = StartSearch();
    for (int block = 0; block < kSearchBlocks && group + block * lanes < count; ++block) {
      const std::uint16_t* from = sums + group + block * lanes;
      // kNoSum would lose its upper bits.
      const V16 most = hn::Set(d, std::uint16_t{0x0FFF});
      const ByteSums limited = {hn::Min(hn::Load(d, from), most),
                                hn::Min(hn::Load(d, from + lanes / 2), most)};
      AddToSearch(limited, block, &search);
    }
    int key = 0;
    const int winner = group + EndSearch(search, &key);
    if ((key >> 4) < best_sum) {
      best_sum = key >> 4;
      best = winner;
    }
  }
  return best;
}

// Whether a sum other than the winner's and its neighbours' is below the threshold. Overwrites those three.
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

// Records the winner of pixel x among the candidates [begin, end).
HWY_INLINE void RecordWinner(const SweepFrame& frame, std::uint16_t* sums, int count, int x,
                             int winner, int begin, int end, const WinnerRow& winners) {
  const std::uint16_t sum = sums[PlaceOfSum(winner)];
  winners.sum[x] = sum;
  winners.before[x] = winner > begin ? sums[PlaceOfSum(winner - 1)] : kNoSum;
  winners.after[x] = winner + 1 < end ? sums[PlaceOfSum(winner + 1)] : kNoSum;
  winners.index[x] = static_cast<std::uint16_t>(winner);
  if (frame.uniqueness_factor > 0) {
    const std::uint32_t threshold =
        static_cast<std::uint32_t>(sum) * static_cast<std::uint32_t>(frame.uniqueness_factor) >> 12;
    if (HasRival(sums, count, winner, threshold)) winners.index[x] |= kNotUnique;
  }
}

// Winner of a pixel where not every disparity stays inside the right image, or not every sum is a disparity's.
HWY_INLINE void SelectAmongCandidates(const SweepFrame& frame, std::uint16_t* sums, int x,
                                      const WinnerRow& winners) {
  const PathLayout& layout = frame.layout;
  const int column = x - frame.min_disparity;
  const int begin = std::clamp(column - (frame.width - 1), 0, layout.range);
  const int end = std::clamp(column + 1, begin, layout.range);
  if (begin >= end) {
    winners.index[x] = kNoWinner;
    return;
  }
  for (int k = 0; k < begin; ++k) sums[PlaceOfSum(k)] = kNoSum;
  for (int k = end; k < layout.padded_range; ++k) sums[PlaceOfSum(k)] = kNoSum;
  RecordWinner(frame, sums, layout.padded_range, x, SearchWinner(sums, layout.padded_range), begin,
               end, winners);
}

}  // namespace HWY_NAMESPACE
}  // namespace adaptive_grid_stereo
HWY_AFTER_NAMESPACE();

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_DISPARITY_SELECTION_INL_H
