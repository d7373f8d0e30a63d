#ifndef ADAPTIVE_GRID_STEREO_BENCHMARK_TARGETS_H
#define ADAPTIVE_GRID_STEREO_BENCHMARK_TARGETS_H

#include <string>
#include <vector>

#include "comparison.h"

namespace adaptive_grid_stereo {

/// One figure that the matcher is held to.
struct Target {
  std::string name;
  std::string unit;  // "" for ratios
  bool larger_is_better = false;
  double bar = 0.0;       // must be reached
  double stretch = 0.0;   // is aimed at
  bool measured = false;  // false: its sizes were not run
  double value = 0.0;
  std::string where;  // which size or method gave it, where the worst of several counts
};

/// Every target with what was measured; `peak_memory_mb` <= 0: not measured.
std::vector<Target> evaluateTargets(const std::vector<Series>& all, double peak_memory_mb);

/// "stretch", "bar", "missed" or "not run".
std::string verdict(const Target& target);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_BENCHMARK_TARGETS_H
