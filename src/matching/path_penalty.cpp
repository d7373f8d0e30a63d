#include "src/matching/sweep.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/matching/path_penalty.cpp"
#include "src/matching/simd-inl.h"
//
#include "src/matching/path_aggregation-inl.h"

HWY_BEFORE_NAMESPACE();
namespace adaptive_grid_stereo {
namespace HWY_NAMESPACE {
namespace hn = AGS_SIMD;

#if HWY_TARGET == HWY_AVX3_DL

// Looks up P2 of a vector of pixels by their grey-level steps, in the whole table at once. Where
// the table, which falls, has come to its last value within a quarter, as by default, that one will
// do.
class PenaltyTable {
 public:
  HWY_ATTR explicit PenaltyTable(const std::uint8_t* table)
      : quarter_will_do_(table[63] == table[255]) {
    for (int i = 0; i < 4; ++i) quarters_[i] = hn::LoadU(D8(), table + 64 * i);
  }
  HWY_INLINE V8 At(V8 step) const {
    if (quarter_will_do_) {
      const V8 place = hn::Min(step, hn::Set(D8(), std::uint8_t{63}));
      return V8{_mm512_permutexvar_epi8(place.raw, quarters_[0].raw)};
    }
    const __m512i low = _mm512_permutex2var_epi8(quarters_[0].raw, step.raw, quarters_[1].raw);
    const __m512i high = _mm512_permutex2var_epi8(quarters_[2].raw, step.raw, quarters_[3].raw);
    return V8{_mm512_mask_mov_epi8(low, _mm512_movepi8_mask(step.raw), high)};
  }

 private:
  V8 quarters_[4];
  bool quarter_will_do_;
};

#else

// Looks up P2 of a vector of pixels by their grey-level steps, sixteen entries at a time. The table
// falls until it stays at its last value; only that part has to be looked up.
class PenaltyTable {
 public:
  HWY_ATTR explicit PenaltyTable(const std::uint8_t* table) : table_(table) {
    while (parts_ > 1 && table[16 * (parts_ - 1) - 1] == table[255]) --parts_;
  }
  HWY_INLINE V8 At(V8 step) const {
    const D8 d;
    const V8 index = hn::And(step, hn::Set(d, std::uint8_t{15}));
    V8 penalty = hn::Set(d, table_[255]);
    for (int t = parts_ - 1; t >= 0; --t) {
      const V8 entries = hn::TableLookupBytes(hn::LoadDup128(d, table_ + 16 * t), index);
      const V8 last = hn::Set(d, static_cast<std::uint8_t>(16 * t + 15));
      penalty = hn::IfThenElse(hn::Eq(hn::Min(step, last), step), entries, penalty);
    }
    return penalty;
  }

 private:
  const std::uint8_t* table_;
  int parts_ = 16;
};

#endif

HWY_ATTR void PenaltyRow(const std::uint8_t* current, const std::uint8_t* const* previous,
                         const std::uint8_t* directions, int begin, int end,
                         const std::uint8_t* table, std::uint8_t* penalties) {
  const D8 d;
  const PenaltyTable penalty_of(table);
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int step = begin; step < end; step += lanes) {
    const V8 grey = hn::LoadU(d, current + step);
    const int count = directions[step / kPenaltyBlock];
    for (int r = 0; r < count; ++r) {
      const V8 other = hn::LoadU(d, previous[r] + step);
      const V8 difference = hn::Sub(hn::Max(grey, other), hn::Min(grey, other));
      hn::Store(penalty_of.At(difference), d, penalties + penaltyPlace(step, r));
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace adaptive_grid_stereo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace adaptive_grid_stereo {
HWY_EXPORT(PenaltyRow);

void penaltyRow(const std::uint8_t* current, const std::uint8_t* const* previous,
                const std::uint8_t* directions, int begin, int end, const std::uint8_t* table,
                std::uint8_t* penalties) {
  HWY_DYNAMIC_DISPATCH(PenaltyRow)(current, previous, directions, begin, end, table, penalties);
}

}  // namespace adaptive_grid_stereo
#endif  // HWY_ONCE
