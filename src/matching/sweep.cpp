#include "src/matching/sweep.h"

#include <algorithm>
#include <cstring>
#include <thread>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/matching/sweep.cpp"
#include "src/matching/simd-inl.h"
//
#include "src/matching/disparity_selection-inl.h"
#include "src/matching/matching_cost-inl.h"
#include "src/matching/path_aggregation-inl.h"

#if !defined(AGS_SWEEP_SHARED)
#define AGS_SWEEP_SHARED
namespace adaptive_grid_stereo {

// Largest range, rounded up to the widest vectors.
constexpr int kMaxRange = 512;

// Bits of the volume's 16 that hold the matching cost; the sum of the first sweep's transitions has
// the rest.
constexpr int kCostBits = 6;
constexpr std::uint16_t kCostMask = 63;

// Waits until the band above has finished `column`; returns how far it has come.
inline int waitFor(const BandProgress& progress, int column) {
  int reached = progress.column.load(std::memory_order_acquire);
  for (int spins = 0; reached < column; ++spins) {
    if (spins > 64) std::this_thread::yield();
    reached = progress.column.load(std::memory_order_acquire);
  }
  return reached;
}

}  // namespace adaptive_grid_stereo
#endif  // AGS_SWEEP_SHARED

HWY_BEFORE_NAMESPACE();
namespace adaptive_grid_stereo {
namespace HWY_NAMESPACE {
namespace hn = AGS_SIMD;

// The census window that has kernels of its own, for inner pixels: the default.
constexpr CensusWindow kUsualWindow = CensusWindow::k9x7;
constexpr int kUsualPlanes = censusPlanes(kUsualWindow);

// A pixel's work, specialised: kDirections 2, 4 or 8; kPadded the padded range if known at compile
// time, else 0; kInner if all disparities stay inside the right image and the window is the usual
// one.
template <int kDirections, int kPadded, bool kInner>
struct PixelSweep {
  static HWY_INLINE int PaddedRange(const SweepFrame& frame) {
    return kPadded ? kPadded : frame.layout.padded_range;
  }
  // Costs, first half of the paths, volume.
  static HWY_INLINE void First(const SweepFrame& frame, const SweepRow& row, int u) {
    const D8 d;
    std::uint8_t* pixel = row.current[u];
    std::uint16_t* volume = row.volume + static_cast<std::size_t>(u) * PaddedRange(frame);
    const CensusPlaces census = FindCensus(frame, row, u);
    V8 smallest[kSweepDirections];
    ForAllVectors(frame, [&](auto count, int k) AGS_LAMBDA {
      constexpr int kVectors = decltype(count)::value;
      const int lanes = static_cast<int>(hn::Lanes(d));
      V8 cost[kVectors];
      for (int i = 0; i < kVectors; ++i) {
        if constexpr (kInner) {
          cost[i] =
              EndCosts(frame, k + i * lanes, HammingDistances<kUsualPlanes>(census, k + i * lanes));
        } else {
          cost[i] = BorderCosts(frame, census, k + i * lanes);
        }
      }
      ByteSums sums[kVectors];
      Aggregate<kVectors>(frame, row, u, pixel, cost, k, smallest, sums);
      for (int i = 0; i < kVectors; ++i) Pack(frame, cost[i], sums[i], volume + k + i * lanes);
    });
    StoreSmallest<kDirections>(d, smallest, pixel);
  }

  // Second half of the paths, sums, winner.
  static HWY_INLINE void Second(const SweepFrame& frame, const SweepRow& row, int u) {
    const D8 d;
    const int x = frame.width - 1 - u;
    std::uint8_t* pixel = row.current[u];
    const std::uint16_t* volume = row.volume + static_cast<std::size_t>(x) * PaddedRange(frame);
    Prefetch(frame, volume);
    alignas(64) std::uint16_t all_sums[kPadded ? kPadded : kMaxRange];
    V8 smallest[kSweepDirections];
    WinnerSearch search = StartSearch();
    ForAllVectors(frame, [&](auto count, int k) AGS_LAMBDA {
      constexpr int kVectors = decltype(count)::value;
      const int lanes = static_cast<int>(hn::Lanes(d));
      V8 cost[kVectors];
      for (int i = 0; i < kVectors; ++i) cost[i] = UnpackCost(frame, volume, k + i * lanes);
      ByteSums sums[kVectors];
      Aggregate<kVectors>(frame, row, u, pixel, cost, k, smallest, sums);
      for (int i = 0; i < kVectors; ++i) {
        const int at = k + i * lanes;
        AddFirstSweep(volume + at, &sums[i]);
        if (kInner) DropSumsBeyond(frame.layout.range, at, &sums[i]);
        hn::Store(sums[i].even, D16(), all_sums + at);
        hn::Store(sums[i].odd, D16(), all_sums + at + lanes / 2);
        if (kInner) AddToSearch(sums[i], at / lanes, &search);
      }
    });
    StoreSmallest<kDirections>(d, smallest, pixel);
    if (kInner) {
      int sum = 0;
      const int winner = EndSearch(search, all_sums, &sum);
      row.winners[x] =
          MakeWinner(frame, all_sums, PaddedRange(frame), winner, sum, 0, frame.layout.range);
    } else {
      row.winners[x] = SelectAmongCandidates(frame, all_sums, x);
    }
  }

 private:
  // Calls f(integral_constant<int, vectors>, first disparity) for two vectors at a time, then one.
  template <class F>
  static HWY_INLINE void ForAllVectors(const SweepFrame& frame, const F& f) {
    using One = std::integral_constant<int, 1>;
    using Two = std::integral_constant<int, 2>;
    const int lanes = static_cast<int>(hn::Lanes(D8()));
    const int padded = PaddedRange(frame);
    int k = 0;
    for (; k + 2 * lanes <= padded; k += 2 * lanes) f(Two(), k);
    if (k < padded) f(One(), k);
  }

  template <int kVectors>
  static HWY_INLINE void Aggregate(const SweepFrame& frame, const SweepRow& row, int u,
                                   std::uint8_t* pixel, const V8* cost, int k, V8* smallest,
                                   ByteSums* sums) {
    AggregateVectors<kDirections, kVectors>(
        row, u, pixel, PaddedRange(frame), cost, k,
        hn::Set(D8(), static_cast<std::uint8_t>(frame.penalty_small)), smallest, sums);
  }

  static HWY_INLINE void Pack(const SweepFrame& frame, V8 cost, const ByteSums& sums,
                              std::uint16_t* volume) {
    const D16 d;
    const V16 cost16 = hn::BitCast(d, cost);
    const V16 even =
        hn::Or(hn::ShiftLeft<kCostBits>(sums.even), hn::And(cost16, hn::Set(d, kCostMask)));
    const V16 odd = hn::Or(hn::ShiftLeft<kCostBits>(sums.odd), hn::ShiftRight<8>(cost16));
    if (frame.stream_volume) {
      hn::Stream(even, d, volume);
      hn::Stream(odd, d, volume + hn::Lanes(d));
    } else {
      hn::Store(even, d, volume);
      hn::Store(odd, d, volume + hn::Lanes(d));
    }
  }

  // The second sweep goes down through memory, where hardware needs help to fetch ahead.
  static HWY_INLINE void Prefetch(const SweepFrame& frame, const std::uint16_t* volume) {
    constexpr int kPixelsAhead = 4, kLine = 64 / sizeof(std::uint16_t);
    const std::uint16_t* ahead = volume - kPixelsAhead * PaddedRange(frame);
    for (int k = 0; k < PaddedRange(frame); k += kLine) __builtin_prefetch(ahead + k);
  }

  static HWY_INLINE V8 UnpackCost(const SweepFrame& frame, const std::uint16_t* volume, int k) {
    const D8 d;
    const D16 d16;
    const V16 mask = hn::Set(d16, kCostMask);
    const V16 even = hn::And(hn::Load(d16, volume + k), mask);
    const V16 odd = hn::And(hn::Load(d16, volume + k + hn::Lanes(d16)), mask);
    const V8 cost = hn::BitCast(d, hn::Or(even, hn::ShiftLeft<8>(odd)));
    return EndCosts(frame, k, cost);
  }

  // Beyond the range the cost is 255 (which the volume has no room for).
  static HWY_INLINE V8 EndCosts(const SweepFrame& frame, int k, V8 cost) {
    const D8 d;
    const int range = frame.layout.range;
    if (k + static_cast<int>(hn::Lanes(d)) <= range) return cost;
    return hn::IfThenElse(hn::FirstN(d, std::max(0, range - k)), cost,
                          hn::Set(d, std::uint8_t{255}));
  }

  // Adds what the first sweep left, and the matching cost once for every path of both sweeps.
  static HWY_INLINE void AddFirstSweep(const std::uint16_t* volume, ByteSums* sums) {
    const D16 d;
    constexpr int kLogPaths = kDirections == 2 ? 2 : kDirections == 4 ? 3 : 4;
    const auto add = [&](V16 sum, V16 packed) AGS_LAMBDA {
      const V16 cost = hn::ShiftLeft<kLogPaths>(hn::And(packed, hn::Set(d, kCostMask)));
      return hn::Add(hn::Add(sum, hn::ShiftRight<kCostBits>(packed)), cost);
    };
    sums->even = add(sums->even, hn::Load(d, volume));
    sums->odd = add(sums->odd, hn::Load(d, volume + hn::Lanes(d)));
  }
};

// Rows r of a band at pixels step - kBandLag * r, for steps [begin, end).
template <int kDirections, int kPadded, bool kInner, bool kSecondSweep>
HWY_NOINLINE HWY_ATTR void SweepRun(const SweepFrame& frame, const SweepRow* rows, int row_count,
                                    int begin, int end) {
  using Pixel = PixelSweep<kDirections, kPadded, kInner>;
  for (int step = begin; step < end; ++step) {
    for (int r = 0; r < row_count; ++r) {
      if (kSecondSweep) {
        Pixel::Second(frame, rows[r], step - kBandLag * r);
      } else {
        Pixel::First(frame, rows[r], step - kBandLag * r);
      }
    }
  }
}

template <int kPadded, bool kInner, bool kSecondSweep>
HWY_INLINE void SweepKind(const SweepFrame& frame, const SweepRow* rows, int row_count, int kind,
                          int begin, int end) {
  switch (kind) {
    case kTwo:
      return SweepRun<2, kPadded, kInner, kSecondSweep>(frame, rows, row_count, begin, end);
    case kFour:
      return SweepRun<4, kPadded, kInner, kSecondSweep>(frame, rows, row_count, begin, end);
    case kEight:
      return SweepRun<8, kPadded, kInner, kSecondSweep>(frame, rows, row_count, begin, end);
  }
}

// A run of pixels of one kind; the usual ranges have kernels of their own.
template <bool kSecondSweep>
HWY_ATTR void SweepPixels(const SweepFrame& frame, const SweepRow* rows, int row_count, int kind,
                          bool inner, int begin, int end) {
  const auto run = [&](auto padded) AGS_LAMBDA {
    constexpr int kPadded = decltype(padded)::value;
    if (inner) {
      SweepKind<kPadded, true, kSecondSweep>(frame, rows, row_count, kind, begin, end);
    } else {
      SweepKind<kPadded, false, kSecondSweep>(frame, rows, row_count, kind, begin, end);
    }
  };
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

// Columns whose disparities all stay inside the right image; none if the inner kernels do not fit.
struct InnerColumns {
  int begin, end;
  bool holds(int u) const { return u >= begin && u < end; }
};

HWY_INLINE InnerColumns FindInnerColumns(const SweepFrame& frame, bool second_sweep) {
  const PathLayout& layout = frame.layout;
  if (frame.window != kUsualWindow ||
      layout.padded_range > kSearchBlocks * static_cast<int>(hn::Lanes(D8()))) {
    return {0, 0};
  }
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
HWY_ATTR void SweepBand(const SweepFrame& frame, const SweepRow* rows, int row_count,
                        const BandProgress* before, BandProgress* own) {
  // Progress is looked at and told once per so many pixels.
  constexpr int kStride = 16;
  const int begin = -kPathMargin, end = frame.width + kPathMargin;
  const int lag = kBandLag * (row_count - 1);
  const InnerColumns inner = FindInnerColumns(frame, kSecondSweep);
  int reached = before ? begin - 1 : end;
  for (int step = begin; step < end + lag;) {
    const int chunk_end = std::min((step / kStride + 1) * kStride, end + lag);
    const int needed = std::min(chunk_end - 1 + kPathMargin, end - 1);
    if (reached < needed) reached = waitFor(*before, needed);
    while (step < chunk_end) {
      int kind = kClear;
      const int uniform = UniformSteps(frame, rows, row_count, step, inner, &kind);
      if (uniform > 0) {
        const int run_end = std::min(chunk_end, step + uniform);
        SweepPixels<kSecondSweep>(frame, rows, row_count, kind, inner.holds(step), step, run_end);
        step = run_end;
        continue;
      }
      for (int r = 0; r < row_count; ++r) {
        const int u = step - kBandLag * r;
        if (u >= begin && u < end) SweepStep<kSecondSweep>(frame, rows[r], u, inner.holds(u));
      }
      ++step;
    }
    own->column.store(step - 1 - lag, std::memory_order_release);
  }
  if (frame.stream_volume) hwy::FlushStream();
  own->column.store(end, std::memory_order_release);
}

HWY_ATTR void RunBand(const SweepFrame& frame, bool second_sweep, const SweepRow* rows,
                      int row_count, const BandProgress* before, BandProgress* own) {
  if (second_sweep) {
    SweepBand<true>(frame, rows, row_count, before, own);
  } else {
    SweepBand<false>(frame, rows, row_count, before, own);
  }
}

HWY_ATTR int SweepLanes() { return static_cast<int>(hn::Lanes(D8())); }

}  // namespace HWY_NAMESPACE
}  // namespace adaptive_grid_stereo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace adaptive_grid_stereo {
HWY_EXPORT(RunBand);
HWY_EXPORT(SweepLanes);

int sweepLanes() { return HWY_DYNAMIC_DISPATCH(SweepLanes)(); }

void runBand(const SweepFrame& frame, bool second_sweep, const SweepRow* rows, int row_count,
             const BandProgress* before, BandProgress* own) {
  HWY_DYNAMIC_DISPATCH(RunBand)(frame, second_sweep, rows, row_count, before, own);
}

}  // namespace adaptive_grid_stereo
#endif  // HWY_ONCE
