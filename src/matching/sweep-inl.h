// The steps of one band: runs of pixels of one kind, each by its kernel. Included once per SIMD
// target.
#if defined(ADAPTIVE_GRID_STEREO_SRC_MATCHING_SWEEP_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef ADAPTIVE_GRID_STEREO_SRC_MATCHING_SWEEP_INL_H
#undef ADAPTIVE_GRID_STEREO_SRC_MATCHING_SWEEP_INL_H
#else
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_SWEEP_INL_H
#endif

#include <cstring>

#include "src/matching/pixel_sweep-inl.h"
#include "src/matching/winner_search-inl.h"

HWY_BEFORE_NAMESPACE();
namespace adaptive_grid_stereo {
namespace HWY_NAMESPACE {
namespace hn = AGS_SIMD;

// Neighbouring rows whose smallest path costs are looked for together: as many as make up the eight
// vectors that one search takes, where there are registers for them beside two vectors' costs.
template <int kDirections, int kPadded>
constexpr int rowsTogether() {
#if HWY_TARGET == HWY_AVX3_DL || HWY_TARGET == HWY_NEON
  if (kDirections == 2) return 4;
  if (kDirections == 4 && kPadded == 64) return 2;
#endif
  return 1;
}

// Whether there is code for all four rows of a step, which then are at fixed distances from each
// other, without a loop over rows: not where that would be long, nor where it has gained nothing.
template <int kDirections, int kPadded>
constexpr bool unrollsRows() {
#if HWY_TARGET == HWY_AVX3_DL || HWY_TARGET == HWY_NEON
  return kPadded > 0 && kDirections * kPadded <= 8 * static_cast<int>(sizeof(V8));
#else
  return false;
#endif
}

// Rows of a band for steps [begin, end).
template <int kDirections, int kPadded, Place kPlace, bool kSecondPass>
HWY_NOINLINE HWY_ATTR void SweepRun(const SweepFrame& frame, const BandRows& band, int begin,
                                    int end) {
  using Pixel = PixelSweep<kDirections, kPadded, kPlace>;
  constexpr int kBits = keyBits<kDirections, kPadded>();
  const BandRow* rows = band.rows;
  const int row_count = band.count;
  const PathPlaces places = band.places;
  const PixelCourse course(frame);
  WinnerSearch<kPadded, kPlace, kBits, kSecondPass, true> search(frame, rows, row_count);
  const PixelConstants constants(frame);
  const auto sweepTogether = [&](auto count, int first, int step) AGS_LAMBDA {
    constexpr int kCount = decltype(count)::value;
    V8 smallest[kCount * kDirections];
    Repeat<kCount>([&](auto i) AGS_LAMBDA {
      constexpr int kRow = decltype(i)::value;
      const int r = first + kRow;
      if constexpr (kSecondPass) {
        Pixel::template Second<kBits>(frame, course, rows[r], NearPlaces(places, step, r), step,
                                      constants, smallest + kRow * kDirections,
                                      search.sums(step, r), search.keys(step, r));
      } else {
        Pixel::First(frame, course, rows[r], NearPlaces(places, step, r), step, constants,
                     smallest + kRow * kDirections);
      }
    });
    const auto pixel = [&](int r) AGS_LAMBDA { return NearPlaces(places, step, r).pixel(); };
    if constexpr (kCount == 1) return StoreSmallest<kDirections>(D8(), smallest, pixel(first));
    constexpr int kBytes = kSmallestCopies * kDirections;
    alignas(32) std::uint8_t bytes[kSmallestCopies * kSweepDirections];
    StoreSmallest<kCount * kDirections>(D8(), smallest, bytes);
    Repeat<kCount>([&](auto i) AGS_LAMBDA {
      std::memcpy(pixel(first + decltype(i)::value), bytes + kBytes * decltype(i)::value, kBytes);
    });
  };
  constexpr int kTogether = rowsTogether<kDirections, kPadded>();
  constexpr std::integral_constant<int, kTogether> together;
  for (int step = begin; step < end; ++step) {
    int r = 0;
    if constexpr (unrollsRows<kDirections, kPadded>()) {
      if (row_count == kBandRows) {
        Repeat<kBandRows / kTogether>([&](auto i) AGS_LAMBDA {
          sweepTogether(together, kTogether * decltype(i)::value, step);
        });
        r = kBandRows;
      }
    } else {
      for (; r + kTogether <= row_count; r += kTogether) sweepTogether(together, r, step);
    }
    for (; r < row_count; ++r) sweepTogether(std::integral_constant<int, 1>(), r, step);
    search.Advance(frame, course, begin, step, {0, row_count});
  }
  search.Finish(frame, course, begin, end - 1, {0, row_count});
}

template <int kPadded, Place kPlace, bool kSecondPass>
HWY_INLINE void SweepKind(const SweepFrame& frame, const BandRows& band, int kind, int begin,
                          int end) {
  switch (kind) {
    case kTwo:
      return SweepRun<2, kPadded, kPlace, kSecondPass>(frame, band, begin, end);
    case kFour:
      return SweepRun<4, kPadded, kPlace, kSecondPass>(frame, band, begin, end);
    case kEight:
      return SweepRun<8, kPadded, kPlace, kSecondPass>(frame, band, begin, end);
  }
}

// Calls f(integral_constant<int, padded range or 0>, integral_constant<Place, place>) for the
// kernels that are made for the range. Plain C++ has but the most general ones: it gains little by
// others, and they would take most of the time to compile.
template <class F>
HWY_INLINE void Specialise(const SweepFrame& frame, bool inner, const F& f) {
  using AnyRange = std::integral_constant<int, 0>;
  using Border = std::integral_constant<Place, Place::kBorder>;
  if (frame.long_range) {
    return f(AnyRange(), std::integral_constant<Place, Place::kLongRange>());
  }
  if constexpr (kPlainCpp) {
    f(AnyRange(), Border());
  } else {
    const auto choosePlace = [&](auto padded) AGS_LAMBDA {
      if (inner) return f(padded, std::integral_constant<Place, Place::kInner>());
      f(padded, Border());
    };
    if (frame.layout.padded_range == 64) return choosePlace(std::integral_constant<int, 64>());
    if (frame.layout.padded_range == 128) return choosePlace(std::integral_constant<int, 128>());
    choosePlace(AnyRange());
  }
}

// A run of pixels of one kind.
template <bool kSecondPass>
HWY_ATTR void SweepPixels(const SweepFrame& frame, const BandRows& band, int kind, bool inner,
                          int begin, int end) {
  Specialise(frame, inner, [&](auto padded, auto place) AGS_LAMBDA {
    constexpr int kPadded = decltype(padded)::value;
    constexpr Place kPlace = decltype(place)::value;
    SweepKind<kPadded, kPlace, kSecondPass>(frame, band, kind, begin, end);
  });
}

// Rows of a band for steps [begin, end), whatever the kinds of their pixels are.
template <int kPadded, Place kPlace, bool kSecondPass>
HWY_NOINLINE HWY_ATTR void SweepMixed(const SweepFrame& frame, const BandRows& band, int begin,
                                      int end) {
  const BandRow* rows = band.rows;
  const int row_count = band.count;
  const PathPlaces places = band.places;
  const PixelCourse course(frame);
  WinnerSearch<kPadded, kPlace, kBlockBits, kSecondPass, false> search(frame, rows, row_count);
  const PixelConstants constants(frame);
  const auto sweepPixel = [&](auto directions, int r, int step) AGS_LAMBDA {
    constexpr int kDirections = decltype(directions)::value;
    using Pixel = PixelSweep<kDirections, kPadded, kPlace>;
    V8 smallest[kDirections];
    const NearPlaces near(places, step, r);
    if constexpr (kSecondPass) {
      Pixel::template Second<kBlockBits>(frame, course, rows[r], near, step, constants, smallest,
                                         search.sums(step, r), search.keys(step, r));
    } else {
      Pixel::First(frame, course, rows[r], near, step, constants, smallest);
    }
    StoreSmallest<kDirections>(D8(), smallest, near.pixel());
  };
  for (int step = begin; step < end; ++step) {
    const ActiveRows active = findActiveRows(frame.width, row_count, step);
    for (int r = active.first; r < active.last; ++r) {
      switch (rows[r].kinds[step]) {
        case kTwo:
          sweepPixel(std::integral_constant<int, 2>(), r, step);
          break;
        case kFour:
          sweepPixel(std::integral_constant<int, 4>(), r, step);
          break;
        case kEight:
          sweepPixel(std::integral_constant<int, 8>(), r, step);
          break;
      }
    }
    search.Advance(frame, course, begin, step, active);
  }
  search.Finish(frame, course, begin, end - 1, {0, row_count});
}

template <bool kSecondPass>
HWY_ATTR void SweepMixedPixels(const SweepFrame& frame, const BandRows& band, bool inner, int begin,
                               int end) {
  Specialise(frame, inner, [&](auto padded, auto place) AGS_LAMBDA {
    constexpr int kPadded = decltype(padded)::value;
    constexpr Place kPlace = decltype(place)::value;
    SweepMixed<kPadded, kPlace, kSecondPass>(frame, band, begin, end);
  });
}

template <bool kSecondPass>
HWY_ATTR void SweepBand(const SweepFrame& frame, const SweepRow* rows, int row_count,
                        const PathPlaces& places, const StepRun* runs, std::size_t run_count) {
  BandRow by_step[kBandRows];
  for (int r = 0; r < row_count; ++r) by_step[r] = AlongSteps(frame, rows[r], r);
  for (const StepRun* run = runs; run != runs + run_count; ++run) {
    if (run->uniform) {
      const int first = run->rows.first;
      const PathPlaces from_first = {places.all + first, places.four + first, places.eight + first};
      SweepPixels<kSecondPass>(frame, {by_step + first, run->rows.count(), from_first}, run->kind,
                               run->inner, run->begin, run->end);
    } else {
      SweepMixedPixels<kSecondPass>(frame, {by_step, row_count, places}, run->inner, run->begin,
                                    run->end);
    }
  }
  if (frame.stream_volume) hwy::FlushStream();
}

}  // namespace HWY_NAMESPACE
}  // namespace adaptive_grid_stereo
HWY_AFTER_NAMESPACE();

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_SWEEP_INL_H
