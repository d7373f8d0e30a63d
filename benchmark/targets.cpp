#include "targets.h"

#include <set>

namespace adaptive_grid_stereo {
namespace {

const char kTeddy[] = "450x375x64";
const char kLarge[] = "1280x720x128";

Target ratioTarget(const std::vector<Series>& all, const std::string& name,
                   const std::string& setting, const std::string& method, const std::string& peer,
                   int threads, double bar, double stretch) {
  Target target{name, "", false, bar, stretch, false, 0.0, ""};
  const Series* ours = find(all, setting, method, threads);
  const Series* theirs = find(all, setting, peer, threads);
  if (ours && theirs) {
    target.measured = true;
    target.value = medianRatio(*ours, *theirs);
  }
  return target;
}

void keepWorst(double value, const std::string& where, Target* target) {
  if (target->measured && value <= target->value) return;
  target->measured = true;
  target->value = value;
  target->where = where;
}

Target savingTarget(const std::vector<Series>& all) {
  Target target{"forward against uniform 16, worst size", "", false, 0.60, 0.52, false, 0.0, ""};
  for (const Series& forward : all) {
    if (forward.method != "forward") continue;
    const Series* uniform = find(all, forward.setting, "uniform 16", forward.threads);
    if (!uniform) continue;
    keepWorst(medianRatio(forward, *uniform),
              forward.setting + ", " + std::to_string(forward.threads) + " threads", &target);
  }
  return target;
}

Target threadsTarget(const std::vector<Series>& all) {
  Target target{
      "2 threads against 1, 640x480 and up, worst", "", false, 0.55, 0.52, false, 0.0, ""};
  const std::set<std::string> small{"256x144x64", kTeddy};
  for (const Series& two : all) {
    if (two.threads != 2 || two.stages.empty() || small.count(two.setting) > 0) continue;
    const Series* one = find(all, two.setting, two.method, 1);
    if (one) keepWorst(medianRatio(two, *one), two.setting + " " + two.method, &target);
  }
  return target;
}

}  // namespace

std::vector<Target> evaluateTargets(const std::vector<Series>& all, double peak_memory_mb) {
  std::vector<Target> targets{ratioTarget(all, "450x375x64, 1 thread: uniform 16 / SGBM", kTeddy,
                                          "uniform 16", "SGBM", 1, 0.72, 0.50),
                              ratioTarget(all, "450x375x64, 1 thread: forward / SGBM", kTeddy,
                                          "forward", "SGBM", 1, 0.42, 0.28),
                              ratioTarget(all, "450x375x64, 1 thread: forward / StereoBM", kTeddy,
                                          "forward", "StereoBM", 1, 1.4, 0.95),
                              ratioTarget(all, "1280x720x128, 2 threads: uniform 16 / SGBM 3WAY",
                                          kLarge, "uniform 16", "SGBM 3WAY", 2, 0.90, 0.60),
                              ratioTarget(all, "1280x720x128, 2 threads: forward / SGBM 3WAY",
                                          kLarge, "forward", "SGBM 3WAY", 2, 0.58, 0.36),
                              ratioTarget(all, "1280x720x128, 2 threads: forward / StereoBM",
                                          kLarge, "forward", "StereoBM", 2, 1.4, 0.85)};

  Target rate{"256x144x64, 2 threads: forward", "frames/s", true, 350.0, 600.0, false, 0.0, ""};
  if (const Series* series = find(all, "256x144x64", "forward", 2)) {
    rate.measured = true;
    rate.value = 1000.0 / medianTime(*series);
  }
  targets.push_back(rate);
  targets.push_back(savingTarget(all));
  targets.push_back(threadsTarget(all));

  Target published{"1024x440x128, 2 threads: uniform 4", "ms", false, 28.5, 17.3, false, 0.0, ""};
  if (const Series* series = find(all, "1024x440x128", "uniform 4", 2)) {
    published.measured = true;
    published.value = medianTime(*series);
  }
  targets.push_back(published);
  targets.push_back({"1280x720x128: peak memory of the process", "MB", false, 600.0, 300.0,
                     peak_memory_mb > 0.0, peak_memory_mb, ""});
  return targets;
}

std::string verdict(const Target& target) {
  if (!target.measured) return "not run";
  const auto reaches = [&](double limit) {
    return target.larger_is_better ? target.value >= limit : target.value <= limit;
  };
  return reaches(target.stretch) ? "stretch" : reaches(target.bar) ? "bar" : "missed";
}

}  // namespace adaptive_grid_stereo
