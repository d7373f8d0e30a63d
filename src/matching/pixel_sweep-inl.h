// One pixel of either sweep: costs, paths, sums, winner. Included once per SIMD target.
#if defined(ADAPTIVE_GRID_STEREO_SRC_MATCHING_PIXEL_SWEEP_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef ADAPTIVE_GRID_STEREO_SRC_MATCHING_PIXEL_SWEEP_INL_H
#undef ADAPTIVE_GRID_STEREO_SRC_MATCHING_PIXEL_SWEEP_INL_H
#else
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_PIXEL_SWEEP_INL_H
#endif

#include <algorithm>
#include <cstring>
#include <type_traits>

#include "src/matching/disparity_selection-inl.h"
#include "src/matching/matching_cost-inl.h"
#include "src/matching/path_aggregation-inl.h"
#include "src/matching/repeat-inl.h"

#if !defined(AGS_SWEEP_SHARED)
#define AGS_SWEEP_SHARED
namespace adaptive_grid_stereo {

// Largest range, rounded up to the widest vectors.
constexpr int kMaxRange = 512;

// Bits of the volume's 16 that hold the matching cost; the sum of the first pass's transitions has
// the rest.
constexpr int kCostBits = 6;
constexpr std::uint16_t kCostMask = 63;

// Where the sum of four transitions is larger than a byte, in the byte of the matching cost.
constexpr std::uint8_t kSumBit = 64;
static_assert(2 * kCostMask + kSumBit < 256, "a cost and a marked cost must fit a byte");
static_assert(4 * kLargestPenalty < 512, "one bit more than a byte must be enough");

}  // namespace adaptive_grid_stereo
#endif  // AGS_SWEEP_SHARED

HWY_BEFORE_NAMESPACE();
namespace adaptive_grid_stereo {
namespace HWY_NAMESPACE {
namespace hn = AGS_SIMD;

// Where a pixel is: all its disparities stay inside the right image, or some do not. kLongRange: as
// kBorder, with more disparities than one search for the winner can take.
enum class Place { kInner, kBorder, kLongRange };

// A sweep's course, and what depends on it. (A copy, since stores of path costs, which are bytes,
// would make compilers load the frame's members anew for every pixel.)
struct PixelCourse : Course {
  HWY_INLINE explicit PixelCourse(const SweepFrame& frame)
      : Course(frame.course),
        census_ahead(along(kCensusAhead)),
        volume_ahead(along(kVolumeAhead) * frame.layout.padded_range) {}

  // How far ahead hardware is helped to fetch the volume, above all where a sweep goes down through
  // memory [px].
  static constexpr int kVolumeAhead = 4;
  std::ptrdiff_t census_ahead;  // [bytes]
  std::ptrdiff_t volume_ahead;  // [numbers]
};

// 255 for those of a vector of disparities from index k on that are beyond the range, else 0.
HWY_INLINE V8 BeyondRange(int range, int k) {
  const D8 d;
  const V8 none = hn::Zero(d), all = hn::Set(d, std::uint8_t{255});
  const int lanes = static_cast<int>(hn::Lanes(d));
  if (k + lanes <= range) return none;
  return hn::IfThenElse(hn::FirstN(d, std::max(0, range - k)), none, all);
}

// What all pixels of a run share.
struct PixelConstants {
  HWY_INLINE explicit PixelConstants(const SweepFrame& frame)
      : penalty_small(hn::Set(D8(), static_cast<std::uint8_t>(frame.penalty_small))),
        beyond(BeyondRange(frame.layout.range,
                           frame.layout.padded_range - static_cast<int>(hn::Lanes(D8())))) {}
  V8 penalty_small;  // P1
  V8 beyond;         // 255 for those of the last vector of disparities that are beyond the range
};

// Row r of a band as its steps go along it.
HWY_INLINE BandRow AlongSteps(const SweepFrame& frame, const SweepRow& row, int r) {
  BandRow by_step;
  static_cast<SweepRow&>(by_step) = row;
  const int steps = kBandLag * r;
  by_step.kinds -= steps;
  const std::ptrdiff_t lag = frame.course.along(steps);
  by_step.first_column = frame.width - 1 + frame.min_disparity + lag;
  by_step.left += kCensusStep * (kCensusMargin - lag);
  by_step.right += kCensusStep * (kCensusMargin + by_step.first_column);
  by_step.volume -= lag * frame.layout.padded_range;
  const WinnerRow& winners = row.winners;
  by_step.winners = {winners.found - lag, winners.odd - lag, winners.even - lag};
  return by_step;
}

// A pixel's work, specialised: kDirections 2, 4 or 8; kPadded the padded range if known at compile
// time, else 0.
template <int kDirections, int kPadded, Place kPlace>
struct PixelSweep {
  static HWY_INLINE int PaddedRange(const SweepFrame& frame) {
    return kPadded ? kPadded : frame.layout.padded_range;
  }
  // Costs, first half of the paths, volume. `smallest` receives the smallest path costs of the
  // directions, one in the lanes of each.
  static HWY_INLINE void First(const SweepFrame& frame, const PixelCourse& course,
                               const BandRow& row, const NearPlaces& near, int step,
                               const PixelConstants& constants, V8* smallest) {
    const D8 d;
    const std::ptrdiff_t x = course.column(step);
    std::uint16_t* volume = row.volume + x * PaddedRange(frame);
    const CensusPlaces census = FindCensus(frame, row, x, course.census_ahead);
    ForAllVectors(frame, [&](auto count, int k) AGS_LAMBDA {
      constexpr int kVectors = decltype(count)::value;
      const int lanes = static_cast<int>(hn::Lanes(d));
      V8 cost[kVectors];
      if constexpr (kPlace == Place::kInner) {
        HammingDistances<kVectors>(frame.window, census, k, cost);
      }
      for (int i = 0; i < kVectors; ++i) {
        const int at = k + i * lanes;
        if constexpr (kPlace != Place::kInner) cost[i] = BorderCosts(frame, census, at);
        cost[i] = EndCosts(frame, constants, at, cost[i]);
      }
      std::conditional_t<kDirections == 4, LowSums, ByteSums> sums[kVectors];
      AggregateVectors<kDirections, kVectors>(row, near, step, PaddedRange(frame), cost, k,
                                              constants.penalty_small, smallest, sums);
      for (int i = 0; i < kVectors; ++i) Pack(frame, cost[i], sums[i], volume + k + i * lanes);
    });
  }

  // Second half of the paths, sums; tells the smallest key of each lane for the winner's search,
  // or, if kLongRange, the winner itself. kBits: of a key below the sum.
  template <int kBits>
  static HWY_INLINE void Second(const SweepFrame& frame, const PixelCourse& course,
                                const BandRow& row, const NearPlaces& near, int step,
                                const PixelConstants& constants, V8* smallest, std::uint16_t* sums,
                                std::uint16_t* keys) {
    const D8 d;
    const D16 d16;
    const std::ptrdiff_t x = course.column(step);
    const std::uint16_t* volume = row.volume + x * PaddedRange(frame);
    Prefetch(frame, volume + course.volume_ahead);
    std::uint16_t* odd_sums = OddSums(sums, PaddedRange(frame));
    const std::ptrdiff_t column = row.first_column - x;  // of the first disparity
    V16 best = hn::Zero(d16);
    ForAllVectors(frame, [&](auto count, int k) AGS_LAMBDA {
      constexpr int kVectors = decltype(count)::value;
      const int lanes = static_cast<int>(hn::Lanes(d));
      V8 cost[kVectors];
      for (int i = 0; i < kVectors; ++i) {
        cost[i] = UnpackCost(frame, constants, volume, k + i * lanes);
      }
      ByteSums part[kVectors];
      AggregateVectors<kDirections, kVectors>(row, near, step, PaddedRange(frame), cost, k,
                                              constants.penalty_small, smallest, part);
      for (int i = 0; i < kVectors; ++i) {
        const int at = k + i * lanes;
        if (kDirections == 8) part[i].Finish();
        AddFirstPass(volume + at, &part[i]);
        DropSumsBeyond(frame, constants, at, &part[i]);
        if (kPlace == Place::kBorder) KeepCandidates(frame, column + at, &part[i]);
        hn::Store(part[i].even, d16, sums + at / 2);
        hn::Store(part[i].odd, d16, odd_sums + at / 2);
        if (kPlace != Place::kLongRange) {
          const V16 of_block = SearchKeys<kBits>(part[i], at / lanes);
          best = at == 0 ? of_block : hn::Min(best, of_block);
        }
      }
    });
    if (kPlace == Place::kLongRange) {
      SelectAmongCandidates(frame, sums, column, row.winners, x);
    } else {
      hn::Store(best, d16, keys);
    }
  }

 private:
  static constexpr int kLanes = static_cast<int>(sizeof(V8));
  // Vectors of disparities that go through the paths together, since they share what is loaded for
  // a path. Four longer ones, for which there are too few registers, are no faster.
  static constexpr int kTogether = kPlainCpp ? 1 : kLanes == 16 ? 4 : 2;

  // Calls f(integral_constant<int, vectors>, first disparity) for all vectors, some at a time;
  // unrolled if the range is known at compile time.
  template <class F>
  static HWY_INLINE void ForAllVectors(const SweepFrame& frame, const F& f) {
    if constexpr (kPadded > 0) {
      constexpr int kAtOnce = std::min(kTogether, kPadded / kLanes);
      static_assert(kPadded % (kAtOnce * kLanes) == 0, "no vector may be left over");
      Repeat<kPadded / (kAtOnce * kLanes)>([&](auto i) AGS_LAMBDA {
        f(std::integral_constant<int, kAtOnce>(), i * kAtOnce * kLanes);
      });
    } else {
      ForVectorsFrom<kTogether>(0, PaddedRange(frame), f);
    }
  }
  template <int kAtOnce, class F>
  static HWY_INLINE void ForVectorsFrom(int k, int padded_range, const F& f) {
    for (; k + kAtOnce * kLanes <= padded_range; k += kAtOnce * kLanes) {
      f(std::integral_constant<int, kAtOnce>(), k);
    }
    if constexpr (kAtOnce > 1) ForVectorsFrom<kAtOnce / 2>(k, padded_range, f);
  }

  // Sums and costs of a vector, for the second pass: side by side in 16 bits; of fewer paths one
  // after the other, where the sum fits a byte, or needs but one bit of the cost's byte.
  static HWY_INLINE void Pack(const SweepFrame& frame, V8 cost, ByteSums sums,
                              std::uint16_t* volume) {
    const D16 d;
    if constexpr (kDirections == 2) return Put(frame, sums.even, hn::BitCast(d, cost), volume);
    sums.Finish();
    const V16 cost16 = hn::BitCast(d, cost);
    const V16 even =
        hn::Or(hn::ShiftLeft<kCostBits>(sums.even), hn::And(cost16, hn::Set(d, kCostMask)));
    const V16 odd = hn::Or(hn::ShiftLeft<kCostBits>(sums.odd), hn::ShiftRight<8>(cost16));
    Put(frame, even, odd, volume);
  }

  static HWY_INLINE void Pack(const SweepFrame& frame, V8 cost, const LowSums& sums,
                              std::uint16_t* volume) {
    const D8 d;
    const V8 bit = hn::Set(d, kSumBit);
#if HWY_TARGET == HWY_AVX3_DL
    const __mmask64 larger = _mm512_cmplt_epu8_mask(sums.low.raw, sums.last.raw);
    const V8 marked{_mm512_mask_add_epi8(cost.raw, larger, cost.raw, bit.raw)};
#else
    const auto smaller = hn::Eq(hn::Max(sums.low, sums.last), sums.low);
    const V8 marked = hn::IfThenElse(smaller, cost, hn::Or(cost, bit));
#endif
    Put(frame, hn::BitCast(D16(), sums.low), hn::BitCast(D16(), marked), volume);
  }

  static HWY_INLINE void Put(const SweepFrame& frame, V16 first, V16 second,
                             std::uint16_t* volume) {
    const D16 d;
    if (frame.stream_volume) {
      hn::Stream(first, d, volume);
      hn::Stream(second, d, volume + hn::Lanes(d));
    } else {
      hn::Store(first, d, volume);
      hn::Store(second, d, volume + hn::Lanes(d));
    }
  }

  static HWY_INLINE void Prefetch(const SweepFrame& frame, const std::uint16_t* volume) {
    constexpr int kLine = 64 / sizeof(std::uint16_t);
    for (int k = 0; k < PaddedRange(frame); k += kLine) __builtin_prefetch(volume + k);
  }

  static HWY_INLINE V8 UnpackCost(const SweepFrame& frame, const PixelConstants& constants,
                                  const std::uint16_t* volume, int k) {
    const D8 d;
    const D16 d16;
    const V16 second = hn::Load(d16, volume + k + hn::Lanes(d16));
    if constexpr (kDirections == 2) return hn::BitCast(d, second);
    if constexpr (kDirections == 4) {
      return EndCosts(frame, constants, k, CostOf(hn::BitCast(d, second)));
    }
    const V16 mask = hn::Set(d16, kCostMask);
    const V16 even = hn::And(hn::Load(d16, volume + k), mask), odd = hn::And(second, mask);
    const V8 cost = hn::BitCast(d, hn::Or(even, hn::ShiftLeft<8>(odd)));
    return EndCosts(frame, constants, k, cost);
  }

  // Without the bit of the sum.
  static HWY_INLINE V8 CostOf(V8 marked) {
    return hn::And(marked, hn::Set(D8(), static_cast<std::uint8_t>(kCostMask)));
  }

  // Whether a vector of disparities from index k on goes beyond the range, or, where to act on it
  // costs less than to ask, may do so: kernels of 16 paths keep the vector units busy, those of
  // fewer all the rest.
  static HWY_INLINE bool Ends(const SweepFrame& frame, int k) {
    if (kPadded > 0 && (kLanes == 16 || k + kLanes < kPadded)) return false;
    return (kPadded > 0 && kDirections < 8) || k + kLanes > frame.layout.range;
  }

  // 255 in the bytes beyond the range.
  static HWY_INLINE V8 Beyond(const SweepFrame& frame, const PixelConstants& constants, int k) {
    if (kPadded > 0) return constants.beyond;
    return BeyondRange(frame.layout.range, k);
  }

  // Beyond the range the cost is 255 (which the volume has no room for).
  static HWY_INLINE V8 EndCosts(const SweepFrame& frame, const PixelConstants& constants, int k,
                                V8 cost) {
    return Ends(frame, k) ? hn::Or(cost, Beyond(frame, constants, k)) : cost;
  }

  // And there are no sums. (The range is even, so both bytes of a lane are 255, or none.)
  static HWY_INLINE void DropSumsBeyond(const SweepFrame& frame, const PixelConstants& constants,
                                        int k, ByteSums* sums) {
    if (!Ends(frame, k)) return;
    const V16 none = hn::BitCast(D16(), Beyond(frame, constants, k));
    sums->even = hn::Or(sums->even, none);
    sums->odd = hn::Or(sums->odd, none);
  }

  // Adds what the first pass left, and the matching cost once for every path of both.
  static HWY_INLINE void AddFirstPass(const std::uint16_t* volume, ByteSums* sums) {
    const D16 d;
    if constexpr (kDirections == 2) {
      // Four times a cost still fits a byte.
      const V16 costs = hn::ShiftLeft<2>(hn::Load(d, volume + hn::Lanes(d)));
      sums->template AddPair<false>(hn::BitCast(D8(), hn::Load(d, volume)));
      sums->template AddPair<false>(hn::BitCast(D8(), costs));
      sums->Finish();
      return;
    }
    if constexpr (kDirections == 4) {
      // Eight times the cost and 256 times the bit are four times the cost and the marked cost.
      const V8 marked = hn::BitCast(D8(), hn::Load(d, volume + hn::Lanes(d)));
      const V16 quarter = hn::BitCast(d, hn::Add(marked, CostOf(marked)));
      const V16 high_bytes = hn::Set(d, std::uint16_t{0xFF << 2});
      sums->template AddPair<false>(hn::BitCast(D8(), hn::Load(d, volume)));
      sums->even = hn::Add(sums->even, hn::ShiftLeft<2>(quarter));
      sums->odd = hn::Add(sums->odd, hn::And(hn::ShiftRight<6>(quarter), high_bytes));
      sums->Finish();
      return;
    }
    const auto add = [&](V16 sum, V16 packed) AGS_LAMBDA {
      const V16 cost = hn::ShiftLeft<4>(hn::And(packed, hn::Set(d, kCostMask)));
      return hn::Add(hn::Add(sum, hn::ShiftRight<kCostBits>(packed)), cost);
    };
    sums->even = add(sums->even, hn::Load(d, volume));
    sums->odd = add(sums->odd, hn::Load(d, volume + hn::Lanes(d)));
  }
};

}  // namespace HWY_NAMESPACE
}  // namespace adaptive_grid_stereo
HWY_AFTER_NAMESPACE();

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_PIXEL_SWEEP_INL_H
