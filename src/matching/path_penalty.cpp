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

// P2 of a vector of pixels by their grey-level steps; `tables` sixteenths of the table have to be
// looked up.
HWY_INLINE V8 LookUpPenalties(D8 d, const std::uint8_t* table, int tables, V8 step) {
  const V8 index = hn::And(step, hn::Set(d, std::uint8_t{15}));
  V8 penalty = hn::Set(d, table[255]);
  for (int t = tables - 1; t >= 0; --t) {
    const V8 entries = hn::TableLookupBytes(hn::LoadDup128(d, table + 16 * t), index);
    const V8 last = hn::Set(d, static_cast<std::uint8_t>(16 * t + 15));
    penalty = hn::IfThenElse(hn::Eq(hn::Min(step, last), step), entries, penalty);
  }
  return penalty;
}

HWY_ATTR void PenaltyRow(const std::uint8_t* current, const std::uint8_t* const* previous,
                         int directions, int begin, int end, const std::uint8_t* table,
                         std::uint8_t* penalties) {
  const D8 d;
  // The table falls until it stays at its last value; only that part has to be looked up.
  int tables = 16;
  while (tables > 1 && table[16 * (tables - 1) - 1] == table[255]) --tables;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int u = begin; u < end; u += lanes) {
    const V8 grey = hn::LoadU(d, current + u);
    for (int r = 0; r < directions; ++r) {
      const V8 other = hn::LoadU(d, previous[r] + u);
      const V8 step = hn::Sub(hn::Max(grey, other), hn::Min(grey, other));
      hn::Store(LookUpPenalties(d, table, tables, step), d, penalties + penaltyPlace(u, r));
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace adaptive_grid_stereo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace adaptive_grid_stereo {
HWY_EXPORT(PenaltyRow);

void penaltyRow(const std::uint8_t* current, const std::uint8_t* const* previous, int directions,
                int begin, int end, const std::uint8_t* table, std::uint8_t* penalties) {
  HWY_DYNAMIC_DISPATCH(PenaltyRow)(current, previous, directions, begin, end, table, penalties);
}

}  // namespace adaptive_grid_stereo
#endif  // HWY_ONCE
