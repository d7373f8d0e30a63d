// The steps of one band: runs of pixels of one kind, each by its kernel. Included once per SIMD
// target.
#if defined(ADAPTIVE_GRID_STEREO_SRC_MATCHING_SWEEP_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef ADAPTIVE_GRID_STEREO_SRC_MATCHING_SWEEP_INL_H
#undef ADAPTIVE_GRID_STEREO_SRC_MATCHING_SWEEP_INL_H
#else
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_SWEEP_INL_H
#endif

#include <algorithm>
#include <cstring>

#include "src/matching/pixel_sweep-inl.h"

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

// Rows r of a band at pixels step - kBandLag * r, for steps [begin, end).
template <int kDirections, int kPadded, Place kPlace, bool kSecondSweep>
HWY_NOINLINE HWY_ATTR void SweepRun(const SweepFrame& frame, const SweepRow* rows, int row_count,
                                    int begin, int end) {
  using Pixel = PixelSweep<kDirections, kPadded, kPlace>;
  constexpr int kSums = kSecondSweep ? sumsSize(kPadded ? kPadded : kMaxRange) : 32;
  constexpr int kKeys = kSecondSweep ? kMaxLanes / 2 : 32;
  // Of two steps in turn: the winners of one are searched after the work of the next, which by then
  // waits for nothing.
  alignas(64) std::uint16_t sums_of_steps[2][kBandRows * kSums];
  alignas(64) std::uint16_t keys_of_steps[2][kBandRows * kKeys];
  constexpr bool kSearchesTogether = kSecondSweep && kPlace != Place::kLongRange;
  if (kSecondSweep) {
    for (int i = 0; i < 2 * kBandRows; ++i) {
      ClearGap(sums_of_steps[0] + i * kSums, Pixel::PaddedRange(frame));
    }
    for (int r = row_count; r < kBandRows; ++r) {
      for (auto& keys : keys_of_steps) std::fill_n(keys + r * kKeys, kKeys, kNoKey);
    }
  }
  const auto storeWinners = [&](int step) AGS_LAMBDA {
    if constexpr (kSearchesTogether) {
      Pixel::StoreWinners(frame, rows, row_count, step, keys_of_steps[step & 1], kKeys,
                          sums_of_steps[step & 1], kSums);
    }
  };
  const auto sweepTogether = [&](auto count, int first, int step) AGS_LAMBDA {
    constexpr int kCount = decltype(count)::value;
    V8 smallest[kCount * kDirections];
    std::uint16_t* sums = sums_of_steps[step & 1];
    std::uint16_t* keys = keys_of_steps[step & 1];
    Repeat<kCount>([&](auto i) AGS_LAMBDA {
      constexpr int kRow = decltype(i)::value;
      const int r = first + kRow, u = step - kBandLag * r;
      if constexpr (kSecondSweep) {
        Pixel::Second(frame, rows[r], u, smallest + kRow * kDirections, sums + r * kSums,
                      keys + r * kKeys);
      } else {
        Pixel::First(frame, rows[r], u, smallest + kRow * kDirections);
      }
    });
    std::uint64_t bytes = SmallestLanes<kCount * kDirections>(D8(), smallest);
    for (int i = 0; i < kCount; ++i, bytes >>= 8 * kDirections % 64) {
      const int r = first + i;
      std::memcpy(rows[r].current[step - kBandLag * r], &bytes, sizeof(bytes));
    }
  };
  constexpr int kTogether = rowsTogether<kDirections, kPadded>();
  for (int step = begin; step < end; ++step) {
    int r = 0;
    for (; r + kTogether <= row_count; r += kTogether) {
      sweepTogether(std::integral_constant<int, kTogether>(), r, step);
    }
    if (kTogether > 1) {
      for (; r < row_count; ++r) sweepTogether(std::integral_constant<int, 1>(), r, step);
    }
    if (step > begin) storeWinners(step - 1);
  }
  storeWinners(end - 1);
}

template <int kPadded, Place kPlace, bool kSecondSweep>
HWY_INLINE void SweepKind(const SweepFrame& frame, const SweepRow* rows, int row_count, int kind,
                          int begin, int end) {
  switch (kind) {
    case kTwo:
      return SweepRun<2, kPadded, kPlace, kSecondSweep>(frame, rows, row_count, begin, end);
    case kFour:
      return SweepRun<4, kPadded, kPlace, kSecondSweep>(frame, rows, row_count, begin, end);
    case kEight:
      return SweepRun<8, kPadded, kPlace, kSecondSweep>(frame, rows, row_count, begin, end);
  }
}

HWY_INLINE bool IsLongRange(const PathLayout& layout) {
  return layout.padded_range > kSearchBlocks * static_cast<int>(hn::Lanes(D8()));
}

// Padded ranges that have kernels of their own, which SweepPixels() chooses.
HWY_INLINE bool HasOwnKernel(int padded_range) { return padded_range == 64 || padded_range == 128; }

// A run of pixels of one kind.
template <bool kSecondSweep>
HWY_ATTR void SweepPixels(const SweepFrame& frame, const SweepRow* rows, int row_count, int kind,
                          bool inner, int begin, int end) {
  const auto run = [&](auto padded) AGS_LAMBDA {
    constexpr int kPadded = decltype(padded)::value;
    if (inner) {
      SweepKind<kPadded, Place::kInner, kSecondSweep>(frame, rows, row_count, kind, begin, end);
    } else {
      SweepKind<kPadded, Place::kBorder, kSecondSweep>(frame, rows, row_count, kind, begin, end);
    }
  };
  if (IsLongRange(frame.layout)) {
    return SweepKind<0, Place::kLongRange, kSecondSweep>(frame, rows, row_count, kind, begin, end);
  }
  switch (frame.layout.padded_range) {
    case 64:
      return run(std::integral_constant<int, 64>());
    case 128:
      return run(std::integral_constant<int, 128>());
    default:
      return run(std::integral_constant<int, 0>());
  }
}

// Path costs of zero let the paths of the directions from `first` on start anew at their next
// pixel.
HWY_INLINE void ClearDirections(const PathLayout& layout, const PathRow& row, int u, int first) {
  std::uint8_t* pixel = row[u];
  for (int r = first; r < kSweepDirections; ++r) {
    pixel[r] = 0;
    std::memset(pixel + kPixelHeader + r * layout.padded_range, 0, layout.range);
  }
}

// One pixel of any kind.
template <bool kSecondSweep>
HWY_ATTR void SweepStep(const SweepFrame& frame, const SweepRow& row, int u, bool inner) {
  const int kind = row.kinds[u];
  const int used = kind & ~kClearRest;
  SweepPixels<kSecondSweep>(frame, &row, 1, used, inner, u, u + 1);
  if (kind == kClear || (kind & kClearRest) != 0) {
    ClearDirections(frame.layout, row.current, u,
                    used == kTwo     ? 2
                    : used == kFour  ? 4
                    : used == kEight ? 8
                                     : 0);
  }
}

// Columns whose disparities all stay inside the right image; none if no kernel makes use of that:
// one for a certain padded range needs it filled.
struct InnerColumns {
  int begin, end;
  bool holds(int u) const { return u >= begin && u < end; }
};

HWY_INLINE InnerColumns FindInnerColumns(const SweepFrame& frame, bool second_sweep) {
  const PathLayout& layout = frame.layout;
  const bool filled = layout.range == layout.padded_range;
  if (IsLongRange(layout) || (HasOwnKernel(layout.padded_range) && !filled)) return {0, 0};
  const int begin = std::max(0, frame.min_disparity + layout.range - 1);
  const int end = std::min(frame.width, frame.width + frame.min_disparity);
  if (second_sweep) return {frame.width - end, frame.width - begin};
  return {begin, end};
}

// Steps from `step` on for which all rows have pixels of one kind, which it tells, and are all
// inside or all outside of the inner columns; 0 if there is none.
HWY_INLINE int UniformSteps(const SweepFrame& frame, const SweepRow* rows, int row_count, int step,
                            const InnerColumns& inner, int* kind) {
  const int last = step - kBandLag * (row_count - 1);
  if (last < 0 || step >= frame.width) return 0;
  *kind = rows[0].kinds[step];
  if (*kind < kTwo || *kind > kEight || inner.holds(step) != inner.holds(last)) return 0;
  int steps = frame.width - step;
  for (int r = 0; r < row_count; ++r) {
    const int u = step - kBandLag * r;
    if (rows[r].kinds[u] != *kind) return 0;
    steps = std::min(steps, rows[r].kind_ends[u] - u);
  }
  for (const int edge : {inner.begin, inner.end}) {
    if (edge > step) steps = std::min(steps, edge - step);
  }
  return steps;
}

template <bool kSecondSweep>
HWY_ATTR void SweepBand(const SweepFrame& frame, const SweepRow* rows, int row_count, int first,
                        int last) {
  const InnerColumns inner = FindInnerColumns(frame, kSecondSweep);
  for (int step = first; step < last;) {
    int kind = kClear;
    const int uniform = UniformSteps(frame, rows, row_count, step, inner, &kind);
    if (uniform > 0) {
      const int run_end = std::min(last, step + uniform);
      SweepPixels<kSecondSweep>(frame, rows, row_count, kind, inner.holds(step), step, run_end);
      step = run_end;
      continue;
    }
    for (int r = 0; r < row_count; ++r) {
      const int u = step - kBandLag * r;
      if (u >= -kPathMargin && u < frame.width + kPathMargin) {
        SweepStep<kSecondSweep>(frame, rows[r], u, inner.holds(u));
      }
    }
    ++step;
  }
  if (frame.stream_volume) hwy::FlushStream();
}

}  // namespace HWY_NAMESPACE
}  // namespace adaptive_grid_stereo
HWY_AFTER_NAMESPACE();

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_SWEEP_INL_H
