#ifndef ADAPTIVE_GRID_STEREO_BENCHMARK_ROOFLINE_H
#define ADAPTIVE_GRID_STEREO_BENCHMARK_ROOFLINE_H

#include <cstdint>

namespace adaptive_grid_stereo {

/// Runs the recurrence of the path costs (eq. 6) of eight directions for `pixels` pixels of 64
/// disparities whose neighbours all lie in the first-level cache: nothing but the kernel's
/// arithmetic. Returns the number of path costs computed (pixels x disparities x paths).
std::int64_t runRecurrenceInCache(int pixels);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_BENCHMARK_ROOFLINE_H
