// The second pass's kernels. Each pass has a file of its own, since they take long to compile.
#include "src/matching/sweep.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/matching/second_pass.cpp"
#include "src/matching/simd-inl.h"
//
#include "src/matching/sweep-inl.h"

HWY_BEFORE_NAMESPACE();
namespace adaptive_grid_stereo {
namespace HWY_NAMESPACE {

HWY_ATTR void RunSecond(const SweepFrame& frame, const SweepRow* rows, int row_count,
                        const PathPlaces& places, const StepRun* runs, std::size_t run_count) {
  SweepBand<true>(frame, rows, row_count, places, runs, run_count);
}

}  // namespace HWY_NAMESPACE
}  // namespace adaptive_grid_stereo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace adaptive_grid_stereo {
HWY_EXPORT(RunSecond);

void runSecondPass(const SweepFrame& frame, const SweepRow* rows, int row_count,
                   const PathPlaces& places, const StepRun* runs, std::size_t run_count) {
  HWY_DYNAMIC_DISPATCH(RunSecond)(frame, rows, row_count, places, runs, run_count);
}

}  // namespace adaptive_grid_stereo
#endif  // HWY_ONCE
