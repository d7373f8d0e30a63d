#ifndef ADAPTIVE_GRID_STEREO_MATCHING_SIMD_TARGET_H
#define ADAPTIVE_GRID_STEREO_MATCHING_SIMD_TARGET_H

#include <string>
#include <vector>

namespace adaptive_grid_stereo {

/// Name of the SIMD target that the kernels run on, e.g. "AVX2"; "portable" for plain C++.
std::string simdTarget();

/// Names of all targets that were built and that this CPU has, best first.
std::vector<std::string> simdTargets();

/// Lets the kernels run on the target of that name, or on the best one for "". All targets give the
/// same bits; this is for tests and comparisons. Throws std::invalid_argument, listing the names,
/// if there is none. Takes effect for the whole process; not while a matcher is at work or before
/// one whose disparity range is already laid out for another target: make a new matcher.
void useSimdTarget(const std::string& name);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_MATCHING_SIMD_TARGET_H
