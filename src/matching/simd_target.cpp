#include "adaptive_grid_stereo/matching/simd_target.h"

#include <cstdint>
#include <stdexcept>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/matching/simd_target.cpp"
#include "src/matching/simd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace adaptive_grid_stereo {
namespace HWY_NAMESPACE {
std::int64_t Target() { return HWY_TARGET; }
}  // namespace HWY_NAMESPACE
}  // namespace adaptive_grid_stereo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace adaptive_grid_stereo {
namespace {

constexpr char kPortable[] = "portable";

#if !defined(AGS_PORTABLE_SIMD)
std::string nameOf(std::int64_t target) {
  return target == HWY_SCALAR ? kPortable : hwy::TargetName(target);
}

std::vector<std::int64_t> targets() {
  std::vector<std::int64_t> result;
  // Better targets have lower bits.
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) result.push_back(target);
  return result;
}
#endif

}  // namespace

HWY_EXPORT(Target);

#if defined(AGS_PORTABLE_SIMD)

std::string simdTarget() { return kPortable; }

std::vector<std::string> simdTargets() { return {kPortable}; }

void useSimdTarget(const std::string& name) {
  if (!name.empty() && name != kPortable) {
    throw std::invalid_argument("SIMD target '" + name + "' is not here, there is: portable");
  }
}

#else

std::string simdTarget() {
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  return nameOf(HWY_DYNAMIC_DISPATCH(Target)());
}

std::vector<std::string> simdTargets() {
  std::vector<std::string> names;
  for (const std::int64_t target : targets()) names.push_back(nameOf(target));
  return names;
}

void useSimdTarget(const std::string& name) {
  hwy::SetSupportedTargetsForTest(0);
  std::string known;
  for (const std::int64_t target : targets()) {
    if (name.empty() || name == nameOf(target)) {
      if (!name.empty()) hwy::SetSupportedTargetsForTest(target);
      hwy::GetChosenTarget().Update(hwy::SupportedTargets());
      return;
    }
    known += " " + nameOf(target);
  }
  throw std::invalid_argument("SIMD target '" + name + "' is not here, there are:" + known);
}

#endif

}  // namespace adaptive_grid_stereo
#endif  // HWY_ONCE
