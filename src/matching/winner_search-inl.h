// The winners of a band's pixels. Included once per SIMD target.
#if defined(ADAPTIVE_GRID_STEREO_SRC_MATCHING_WINNER_SEARCH_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef ADAPTIVE_GRID_STEREO_SRC_MATCHING_WINNER_SEARCH_INL_H
#undef ADAPTIVE_GRID_STEREO_SRC_MATCHING_WINNER_SEARCH_INL_H
#else
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_WINNER_SEARCH_INL_H
#endif

#include <algorithm>

#include "src/matching/pixel_sweep-inl.h"
#include "src/matching/repeat-inl.h"

HWY_BEFORE_NAMESPACE();
namespace adaptive_grid_stereo {
namespace HWY_NAMESPACE {
namespace hn = AGS_SIMD;

// Keeps sums and keys of a few steps in turn: the smallest keys of one are searched after the work
// of the next, and the winners after that of the one after, so that neither waits for anything.
// kBits: of a key below the sum. kAllRows: all rows have pixels at all steps. Does nothing in the
// first pass; pixels of long ranges find their winners by themselves.
//
// (Parameters that recur are no members: stores of path costs, which are bytes, would make
// compilers load them anew for every pixel.)
template <int kPadded, Place kPlace, int kBits, bool kSecondPass, bool kAllRows>
class WinnerSearch {
 public:
  HWY_INLINE WinnerSearch(const SweepFrame& frame, const BandRow* rows, int row_count) {
    if (!kSecondPass) return;
    for (int r = 0; r < row_count; ++r) winners_[r] = rows[r].winners;
    // Rows that are searched without being there.
    const int first_spare = kAllRows ? row_count : 0;
    for (Slot& slot : slots_) {
      for (auto& sums : slot.sums) ClearGap(sums, PaddedRange(frame));
      for (int r = first_spare; r < kKeyRows; ++r) std::fill_n(slot.keys[r], kKeys, kNoSum);
    }
  }

  // Where the sums and the keys of row r's pixel at a step belong.
  HWY_INLINE std::uint16_t* sums(int step, int r) { return slots_[slotOf(step)].sums[r]; }
  HWY_INLINE std::uint16_t* keys(int step, int r) { return slots_[slotOf(step)].keys[r]; }

  // Goes on after the work of a step in which these rows had pixels; `begin` is the first step.
  HWY_INLINE void Advance(const SweepFrame& frame, const PixelCourse& course, int begin, int step,
                          const ActiveRows& active) {
    if constexpr (kOn) {
      if (!kAllRows) active_[slotOf(step)] = active;
      if (step > begin + 1) StoreWinners(frame, course, step - 2, active);
      if (step > begin) FindSmallestKeys(step - 1);
    }
  }

  // Goes on after the last step.
  HWY_INLINE void Finish(const SweepFrame& frame, const PixelCourse& course, int begin, int last,
                         const ActiveRows& active) {
    if constexpr (kOn) {
      if (last > begin) StoreWinners(frame, course, last - 1, active);
      FindSmallestKeys(last);
      StoreWinners(frame, course, last, active);
    }
  }

 private:
  static constexpr bool kOn = kSecondPass && kPlace != Place::kLongRange;
  static constexpr int kSlots = 4;
  static constexpr int kSums = sumsSize(kPadded ? kPadded : kMaxRange);
  static constexpr int kKeys = kMaxLanes / 2;
  // The search looks at four rows from the first active one on.
  static constexpr int kKeyRows = kAllRows ? kBandRows : 2 * kBandRows - 1;

  static int slotOf(int step) { return step & (kSlots - 1); }

  static HWY_INLINE int PaddedRange(const SweepFrame& frame) {
    return kPadded ? kPadded : frame.layout.padded_range;
  }

  HWY_INLINE void FindSmallestKeys(int step) {
    static_assert(kBandRows == 4, "four rows are searched together");
    const D16 d;
    const int slot = slotOf(step);
    const auto* keys = slots_[slot].keys + (kAllRows ? 0 : active_[slot].first);
    const auto smallest = SmallestKeys(hn::Load(d, keys[0]), hn::Load(d, keys[1]),
                                       hn::Load(d, keys[2]), hn::Load(d, keys[3]));
    StoreHalves<kBits>(smallest, slots_[slot].smallest);
  }

  // all: the active rows if kAllRows.
  HWY_INLINE void StoreWinners(const SweepFrame& frame, const PixelCourse& course, int step,
                               const ActiveRows& all) {
    const int slot = slotOf(step);
    const int first = kAllRows ? 0 : active_[slot].first;
    const int count = kAllRows ? all.last : active_[slot].count();
    const std::ptrdiff_t x = course.column(step);
    Repeat<kBandRows>([&](auto i) AGS_LAMBDA {
      constexpr int kRow = decltype(i)::value;
      if (kRow >= count) return;
      const int r = first + kRow;
      const std::uint32_t halves = slots_[slot].smallest[kRow];
      const std::uint32_t number = lowHalf(halves), sum = highHalf(halves);
      const std::uint32_t place = PlaceOfKey<kBits, kPadded>(number, sum, slots_[slot].keys[r]);
      PutWinner(slots_[slot].sums[r], PaddedRange(frame), {place, sum}, winners_[r], x);
    });
    if (frame.uniqueness_factor == 0) return;
    for (int r = first; r < first + count; ++r) {
      std::uint32_t* found = winners_[r].found + x;
      MarkAmbiguous(frame, slots_[slot].sums[r], PaddedRange(frame), found);
    }
  }

  // One after the other, so that all is found from one address.
  struct Slot {
    alignas(64) std::uint16_t sums[kBandRows][kSums];
    alignas(64) std::uint16_t keys[kKeyRows][kKeys];
    // Of four rows: the number below the sum in the smallest key (low half), and the sum.
    alignas(16) std::uint32_t smallest[kBandRows];
  };
  Slot slots_[kSlots];
  ActiveRows active_[kSlots];
  WinnerRow winners_[kBandRows];  // of the band's rows
};

}  // namespace HWY_NAMESPACE
}  // namespace adaptive_grid_stereo
HWY_AFTER_NAMESPACE();

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_WINNER_SEARCH_INL_H
