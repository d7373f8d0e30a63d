// Winner-takes-all and uniqueness of one pixel. Included once per SIMD target.
#if defined(ADAPTIVE_GRID_STEREO_SRC_MATCHING_DISPARITY_SELECTION_INL_H) == \
    defined(HWY_TARGET_TOGGLE)
#ifdef ADAPTIVE_GRID_STEREO_SRC_MATCHING_DISPARITY_SELECTION_INL_H
#undef ADAPTIVE_GRID_STEREO_SRC_MATCHING_DISPARITY_SELECTION_INL_H
#else
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_DISPARITY_SELECTION_INL_H
#endif

#include <algorithm>
#include <cstring>

#include "src/matching/path_aggregation-inl.h"
#include "src/matching/sweep.h"

HWY_BEFORE_NAMESPACE();
namespace adaptive_grid_stereo {
namespace HWY_NAMESPACE {
namespace hn = AGS_SIMD;

// Between the sums of a pixel's even disparities and those of the odd ones: no sums, so that the
// neighbours of the first and the last disparity are none.
constexpr int kSumGap = 32;

// The sums of a pixel: those of its even disparities, the gap, those of the odd ones. Neighbours of
// either kind stand side by side among the other.
constexpr int sumsSize(int padded_range) { return padded_range + kSumGap; }
template <class T>
HWY_INLINE T* OddSums(T* sums, int padded_range) {
  return sums + padded_range / 2 + kSumGap;
}
HWY_INLINE void ClearGap(std::uint16_t* sums, int padded_range) {
  std::fill_n(sums + padded_range / 2, kSumGap, kNoSum);
}

// The smallest sum of each lane, while blocks of as many disparities as a vector has bytes pass.
//
// Sums of 16 paths stay below 4096, so four bits are free for the number of the block: one minimum
// per lane then finds both. Sums of fewer paths leave more bits, which for short ranges hold the
// lane as well, so that the smallest key tells all. A sum of kNoSum loses against every other.
constexpr int kBlockBits = 4;
static_assert(kSearchBlocks == 1 << kBlockBits, "block numbers must fit their bits");

// Bits of a key below the sum, of pixels with so many directions per sweep: enough for the place
// among the sums of one parity, or else for the number of the block.
template <int kDirections, int kPadded>
constexpr int keyBits() {
  constexpr int kFree = kDirections == 2 ? 6 : kDirections == 4 ? 5 : kBlockBits;
  return kPadded > 0 && kPadded / 2 <= 1 << kFree ? kFree : kBlockBits;
}

/// Keys from this one on are those of no sum.
template <int kBits>
constexpr std::uint16_t kNoKey = static_cast<std::uint16_t>(kNoSum << kBits);

template <int kBits>
HWY_INLINE V16 SearchKeys(const ByteSums& sums, int block) {
  const D16 d;
  const int number = kBits > kBlockBits ? block * static_cast<int>(hn::Lanes(d)) : block;
  V16 numbers = hn::Set(d, static_cast<std::uint16_t>(number));
  if (kBits > kBlockBits) numbers = hn::Add(numbers, hn::Iota(d, 0));
  return hn::Or(hn::ShiftLeft<kBits>(hn::Min(sums.even, sums.odd)), numbers);
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

// Smallest key of each of four vectors: 16 bits each, the first one lowest.
HWY_INLINE std::uint64_t SmallestKeys(V16 a, V16 b, V16 c, V16 e) {
#if AGS_PAIRWISE_MIN
  const auto all = vpminq_u16(vpminq_u16(a.raw, b.raw), vpminq_u16(c.raw, e.raw));
  return vgetq_lane_u64(vreinterpretq_u64_u16(vpminq_u16(all, all)), 0);
#else
  const D16 d;
  const hn::Repartition<std::uint32_t, D16> d32;
  const auto merge16 = [&](V16 v, V16 w) AGS_LAMBDA {
    return hn::Min(hn::InterleaveLower(d, v, w), hn::InterleaveUpper(d, v, w));
  };
  const auto ab = hn::BitCast(d32, merge16(a, b)), ce = hn::BitCast(d32, merge16(c, e));
  const V16 all = hn::Min(hn::BitCast(d, hn::InterleaveLower(d32, ab, ce)),
                          hn::BitCast(d, hn::InterleaveUpper(d32, ab, ce)));
  const hn::Full128<std::uint16_t> d128;
  auto block = FoldSums(all);
  block = hn::Min(block, hn::ShiftRightBytes<8>(d128, block));
  return hn::GetLane(hn::BitCast(hn::Full128<std::uint64_t>(), block));
#endif
}

// The winning place among the sums of one parity, by the smallest key and the keys it is among.
// kPadded: the padded range if known, else 0.
template <int kBits, int kPadded>
HWY_INLINE int PlaceOfKey(std::uint16_t key, const std::uint16_t* keys) {
  const D16 d;
  const int number = key & ((1 << kBits) - 1), lanes = static_cast<int>(hn::Lanes(d));
  if (kBits > kBlockBits) return number;
  const auto found = hn::Eq(hn::Load(d, keys), hn::Set(d, key));
  const int lane = static_cast<int>(hn::FindKnownFirstTrue(d, found));
  return kPadded > 0 && kPadded / 2 <= lanes ? lane : number * lanes + lane;
}

// The disparities of a pixel that stay inside the right image: indices begin .. end - 1.
struct Candidates {
  int begin, end;
  bool none() const { return begin >= end; }
};

HWY_INLINE Candidates FindCandidates(const SweepFrame& frame, int x) {
  const int column = x - frame.min_disparity, range = frame.layout.range;
  const int begin = std::clamp(column - (frame.width - 1), 0, range);
  return {begin, std::clamp(column + 1, begin, range)};
}

// Sums of a block beginning at disparity index `at` that are no candidate's become kNoSum.
HWY_INLINE void KeepCandidates(const Candidates& candidates, int at, ByteSums* sums) {
  const D16 d;
  const int lanes = static_cast<int>(hn::Lanes(D8()));
  const V16 none = hn::Set(d, kNoSum);
  // The even disparities among the first n, and the odd ones.
  const auto firstEven = [&](std::size_t n) AGS_LAMBDA { return hn::FirstN(d, (n + 1) / 2); };
  const auto firstOdd = [&](std::size_t n) AGS_LAMBDA { return hn::FirstN(d, n / 2); };
  const std::size_t end = std::clamp(candidates.end - at, 0, lanes);
  sums->even = hn::IfThenElse(firstEven(end), sums->even, none);
  sums->odd = hn::IfThenElse(firstOdd(end), sums->odd, none);
  if (candidates.begin <= at) return;
  const std::size_t begin = std::min(candidates.begin - at, lanes);
  sums->even = hn::IfThenElse(firstEven(begin), none, sums->even);
  sums->odd = hn::IfThenElse(firstOdd(begin), none, sums->odd);
}

// Sums of a block beginning at disparity index `at` become kNoSum from index `range` on.
HWY_INLINE void DropSumsBeyond(int range, int at, ByteSums* sums) {
  if (at + static_cast<int>(hn::Lanes(D8())) <= range) return;
  KeepCandidates({0, range}, at, sums);
}

// A winning sum and its place among those of one parity.
struct PlacedSum {
  int place, sum;
};

// The winner among the candidates, of which there is one at least, of any number of sums in memory;
// the other sums become kNoSum.
HWY_INLINE PlacedSum SearchCandidates(std::uint16_t* sums, int padded_range,
                                      const Candidates& candidates) {
  const D16 d;
  const int lanes = static_cast<int>(hn::Lanes(D8()));
  std::uint16_t* odd_sums = OddSums(sums, padded_range);
  PlacedSum best{0, 0x10000};
  for (int group = 0; group < padded_range; group += kSearchBlocks * lanes) {
    V16 keys = hn::Set(d, kNoSum);
    for (int block = 0; block < kSearchBlocks && group + block * lanes < padded_range; ++block) {
      const int at = group + block * lanes;
      ByteSums of_block(hn::Load(d, sums + at / 2), hn::Load(d, odd_sums + at / 2));
      KeepCandidates(candidates, at, &of_block);
      hn::Store(of_block.even, d, sums + at / 2);
      hn::Store(of_block.odd, d, odd_sums + at / 2);
      keys = hn::Min(keys, SearchKeys<kBlockBits>(of_block, block));
    }
    const std::uint16_t key = static_cast<std::uint16_t>(SmallestKeys(keys, keys, keys, keys));
    if (key >> kBlockBits < best.sum) {
      alignas(64) std::uint16_t of_lanes[kMaxLanes / 2];
      hn::Store(keys, d, of_lanes);
      best = {group / 2 + PlaceOfKey<kBlockBits, 0>(key, of_lanes), key >> kBlockBits};
    }
  }
  return best;
}

// Whether a sum other than the winner's and its neighbours' is below the threshold. Overwrites
// those three.
HWY_INLINE bool HasRival(std::uint16_t* sums, int padded_range, int winner,
                         std::uint32_t threshold) {
  const D16 d;
  std::uint16_t* odd_sums = OddSums(sums, padded_range);
  for (int k = std::max(0, winner - 1); k <= std::min(padded_range - 1, winner + 1); ++k) {
    // In two steps: GCC 12's undefined-behaviour sanitizer gets (a ? b : c)[i] wrong.
    std::uint16_t* of_parity = k % 2 == 0 ? sums : odd_sums;
    of_parity[k / 2] = kNoSum;
  }
  const V16 limit =
      hn::Set(d, static_cast<std::uint16_t>(std::min<std::uint32_t>(threshold, 0xFFFF)));
  V16 below = hn::Zero(d);
  for (int at = 0; at < padded_range / 2; at += static_cast<int>(hn::Lanes(d))) {
    below = hn::Or(below, hn::Or(hn::SaturatedSub(limit, hn::Load(d, sums + at)),
                                 hn::SaturatedSub(limit, hn::Load(d, odd_sums + at))));
  }
  return !hn::AllTrue(d, hn::Eq(below, hn::Zero(d)));
}

// Puts down that pixel x has no winner.
HWY_INLINE void PutNoWinner(const WinnerRow& row, std::ptrdiff_t x) {
  row.found[x] = kNoWinner | std::uint32_t{kNoSum} << 16;
  row.odd[x] = row.even[x] = kNoSum | std::uint32_t{kNoSum} << 16;
}

// Puts down the winner of pixel x, by its place among the sums of one parity and its sum; sums that
// are no candidate's must be kNoSum.
HWY_INLINE void PutWinner(const std::uint16_t* sums, int padded_range, int place, std::uint32_t sum,
                          const WinnerRow& row, std::ptrdiff_t x) {
  row.found[x] = sum << 16 | static_cast<std::uint32_t>(place);
  // Low half first, as the CPUs that this is built for have it.
  std::memcpy(row.odd + x, OddSums(sums, padded_range) + place - 1, sizeof(row.odd[x]));
  std::memcpy(row.even + x, sums + place, sizeof(row.even[x]));
}

// Marks a winner that has a rival within the uniqueness ratio. Overwrites the sums around it.
HWY_INLINE void MarkAmbiguous(const SweepFrame& frame, std::uint16_t* sums, int padded_range,
                              std::uint32_t* found) {
  const std::uint32_t sum = highHalf(*found);
  const std::uint32_t threshold = sum * static_cast<std::uint32_t>(frame.uniqueness_factor) >> 12;
  const int place = static_cast<int>(lowHalf(*found));
  // Of even and odd sums that are equal, the even one wins.
  const int index = 2 * place + (sums[place] != sum);
  if (HasRival(sums, padded_range, index, threshold)) *found |= kNotUnique;
}

// Puts down the winner of a pixel with more disparities than one search can take.
HWY_INLINE void SelectAmongCandidates(const SweepFrame& frame, std::uint16_t* sums,
                                      const Candidates& candidates, const WinnerRow& row,
                                      std::ptrdiff_t x) {
  const PathLayout& layout = frame.layout;
  if (candidates.none()) return PutNoWinner(row, x);
  const PlacedSum best = SearchCandidates(sums, layout.padded_range, candidates);
  PutWinner(sums, layout.padded_range, best.place, static_cast<std::uint32_t>(best.sum), row, x);
  if (frame.uniqueness_factor > 0) {
    MarkAmbiguous(frame, sums, layout.padded_range, row.found + x);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace adaptive_grid_stereo
HWY_AFTER_NAMESPACE();

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_DISPARITY_SELECTION_INL_H
