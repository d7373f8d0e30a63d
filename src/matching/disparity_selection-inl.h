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

using D16Block = hn::Full128<std::uint16_t>;
using V16Block = hn::Vec<D16Block>;

// Smallest key of each of four vectors, in the first four lanes.
HWY_INLINE V16Block SmallestKeys(V16 a, V16 b, V16 c, V16 e) {
#if AGS_PAIRWISE_MIN
  const auto all = vpminq_u16(vpminq_u16(a.raw, b.raw), vpminq_u16(c.raw, e.raw));
  return V16Block{vpminq_u16(all, all)};
#else
  const D16 d;
  const hn::Repartition<std::uint32_t, D16> d32;
  const auto merge16 = [&](V16 v, V16 w) AGS_LAMBDA {
    return hn::Min(hn::InterleaveLower(d, v, w), hn::InterleaveUpper(d, v, w));
  };
  const auto ab = hn::BitCast(d32, merge16(a, b)), ce = hn::BitCast(d32, merge16(c, e));
  const V16 all = hn::Min(hn::BitCast(d, hn::InterleaveLower(d32, ab, ce)),
                          hn::BitCast(d, hn::InterleaveUpper(d32, ab, ce)));
  const V16Block block = FoldSums(all);
  return hn::Min(block, hn::ShiftRightBytes<8>(D16Block(), block));
#endif
}

// Takes the first four keys apart: the number below the sum (low half) and the sum.
template <int kBits>
HWY_INLINE void StoreHalves(V16Block keys, std::uint32_t* halves_of_keys) {
  const D16Block d;
  const V16Block low = hn::And(keys, hn::Set(d, static_cast<std::uint16_t>((1 << kBits) - 1)));
  const V16Block halves = hn::InterleaveLower(d, low, hn::ShiftRight<kBits>(keys));
  hn::Store(halves, d, reinterpret_cast<std::uint16_t*>(halves_of_keys));
}

// The winning place among the sums of one parity, by the number below the sum in the smallest key
// and the keys that this is among. kPadded: the padded range if known, else 0.
template <int kBits, int kPadded>
HWY_INLINE std::uint32_t PlaceOfKey(std::uint32_t number, std::uint32_t sum,
                                    const std::uint16_t* keys) {
  const D16 d;
  if (kBits > kBlockBits) return number;
  const auto key = hn::Set(d, static_cast<std::uint16_t>(sum << kBits | number));
  const std::size_t lane = hn::FindKnownFirstTrue(d, hn::Eq(hn::Load(d, keys), key));
  const std::uint32_t lanes = static_cast<std::uint32_t>(hn::Lanes(d));
  const std::uint32_t first = kPadded > 0 && kPadded / 2 <= lanes ? 0 : number * lanes;
  return first + static_cast<std::uint32_t>(lane);
}

// Sums of a vector of disparities become kNoSum where their columns in the right image, from
// `first` on, are outside of it.
HWY_INLINE void KeepCandidates(const SweepFrame& frame, std::ptrdiff_t first, ByteSums* sums) {
  const D16 d;
  const hn::Repartition<std::int16_t, D8> signed_d;
  const auto outside = hn::BitCast(signed_d, hn::LoadU(D8(), frame.outside + first));
  const auto even = hn::ShiftRight<8>(hn::ShiftLeft<8>(outside)), odd = hn::ShiftRight<8>(outside);
  sums->even = hn::Or(sums->even, hn::BitCast(d, even));
  sums->odd = hn::Or(sums->odd, hn::BitCast(d, odd));
}

// A winning sum and its place among those of one parity.
struct PlacedSum {
  std::uint32_t place, sum;
};

// The winner among the candidates of any number of sums in memory; the other sums become kNoSum.
// Without any candidate, its sum is one from sumLimit() on. column: of the first disparity in the
// right image.
HWY_INLINE PlacedSum SearchCandidates(const SweepFrame& frame, std::ptrdiff_t column,
                                      std::uint16_t* sums) {
  const D16 d;
  const int lanes = static_cast<int>(hn::Lanes(D8()));
  const int padded_range = frame.layout.padded_range;
  std::uint16_t* odd_sums = OddSums(sums, padded_range);
  PlacedSum best{0, kNoSum};
  for (int group = 0; group < padded_range; group += kSearchBlocks * lanes) {
    V16 keys = hn::Set(d, kNoSum);
    for (int block = 0; block < kSearchBlocks && group + block * lanes < padded_range; ++block) {
      const int at = group + block * lanes;
      ByteSums of_block(hn::Load(d, sums + at / 2), hn::Load(d, odd_sums + at / 2));
      KeepCandidates(frame, column + at, &of_block);
      hn::Store(of_block.even, d, sums + at / 2);
      hn::Store(of_block.odd, d, odd_sums + at / 2);
      keys = hn::Min(keys, SearchKeys<kBlockBits>(of_block, block));
    }
    alignas(16) std::uint32_t halves[4];
    StoreHalves<kBlockBits>(SmallestKeys(keys, keys, keys, keys), halves);
    const std::uint32_t number = lowHalf(halves[0]), sum = highHalf(halves[0]);
    if (sum < best.sum) {
      alignas(64) std::uint16_t of_lanes[kMaxLanes / 2];
      hn::Store(keys, d, of_lanes);
      const std::uint32_t first = static_cast<std::uint32_t>(group / 2);
      best = {first + PlaceOfKey<kBlockBits, 0>(number, sum, of_lanes), sum};
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

// Puts down the winner of pixel x, by its place among the sums of one parity and its sum; sums that
// are no candidate's must be kNoSum.
HWY_INLINE void PutWinner(const std::uint16_t* sums, int padded_range, const PlacedSum& winner,
                          const WinnerRow& row, std::ptrdiff_t x) {
  const std::uint32_t place = winner.place;
  row.found[x] = winner.sum << 16 | place;
  // Low half first, as the CPUs that this is built for have it.
  std::memcpy(row.odd + x, OddSums(sums, padded_range) - 1 + place, sizeof(row.odd[x]));
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
                                      std::ptrdiff_t column, const WinnerRow& row,
                                      std::ptrdiff_t x) {
  const PathLayout& layout = frame.layout;
  const PlacedSum best = SearchCandidates(frame, column, sums);
  PutWinner(sums, layout.padded_range, best, row, x);
  if (frame.uniqueness_factor > 0) {
    MarkAmbiguous(frame, sums, layout.padded_range, row.found + x);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace adaptive_grid_stereo
HWY_AFTER_NAMESPACE();

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_DISPARITY_SELECTION_INL_H
