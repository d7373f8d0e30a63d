// The SIMD layer, once per target: Google Highway, or, without it and for CPUs below its targets, a
// portable stand-in with the same names (AGS_SIMD is the namespace of either).
//
// No include guard: a file that includes this defines HWY_TARGET_INCLUDE and is itself included
// once per target.
#if defined(AGS_PORTABLE_SIMD)
#include "src/matching/portable_simd.h"
#else
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>  // must precede highway.h
#include <hwy/highway.h>
#include "src/matching/portable_simd.h"
#endif

#undef AGS_SIMD
#if defined(AGS_PORTABLE_SIMD) || HWY_TARGET == HWY_SCALAR
#define AGS_SIMD ::adaptive_grid_stereo::portable_simd
#else
#define AGS_SIMD ::hwy::HWY_NAMESPACE
#endif

// Lambdas inside kernels need the target's attribute, and must not become calls that pass vectors
// in memory.
#undef AGS_LAMBDA
#define AGS_LAMBDA HWY_ATTR __attribute__((always_inline))
