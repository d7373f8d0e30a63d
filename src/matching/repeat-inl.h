// Unrolled loops. Included once per SIMD target.
#if defined(ADAPTIVE_GRID_STEREO_SRC_MATCHING_REPEAT_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef ADAPTIVE_GRID_STEREO_SRC_MATCHING_REPEAT_INL_H
#undef ADAPTIVE_GRID_STEREO_SRC_MATCHING_REPEAT_INL_H
#else
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_REPEAT_INL_H
#endif

#include <type_traits>

HWY_BEFORE_NAMESPACE();
namespace adaptive_grid_stereo {
namespace HWY_NAMESPACE {

// Calls f(integral_constant<int, i>) for i = 0 .. kCount - 1, unrolled.
template <int kCount, int kFirst = 0, class F>
HWY_INLINE void Repeat(const F& f) {
  if constexpr (kFirst < kCount) {
    f(std::integral_constant<int, kFirst>());
    Repeat<kCount, kFirst + 1>(f);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace adaptive_grid_stereo
HWY_AFTER_NAMESPACE();

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_REPEAT_INL_H
