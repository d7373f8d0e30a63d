#include "adaptive_grid_stereo/matching/matcher_config.h"

#include <algorithm>
#include <stdexcept>

#include "src/common/corrections.h"

namespace adaptive_grid_stereo {

const char* toString(CensusWindow window) {
  switch (window) {
    case CensusWindow::k5x5:
      return "5x5";
    case CensusWindow::k7x7:
      return "7x7";
    case CensusWindow::k9x7:
      break;
  }
  return "9x7";
}

CensusWindow censusWindowFromString(const std::string& name) {
  for (const CensusWindow window : {CensusWindow::k5x5, CensusWindow::k7x7, CensusWindow::k9x7}) {
    if (name == toString(window)) return window;
  }
  throw std::invalid_argument("census_window '" + name + "' is unknown, expected " +
                              kCensusWindowNames);
}

std::vector<std::string> MatcherConfig::validate() {
  const MatcherConfig defaults;
  Corrections corrections;
  corrections.limit("min_disparity", -1024, 1024, &min_disparity);
  corrections.limit("disparity_range", 16, 512, &disparity_range);
  corrections.set("disparity_range", (disparity_range + 15) / 16 * 16, "a multiple of 16",
                  &disparity_range);
  corrections.limit("penalty_small", 0, kLargestPenalty - 1, &penalty_small);
  corrections.limit("penalty_large_min", 1, kLargestPenalty, &penalty_large_min);
  corrections.set("penalty_large_min", std::max(penalty_large_min, penalty_small + 1),
                  "must exceed penalty_small", &penalty_large_min);
  corrections.limit("penalty_large", 1, 2000, &penalty_large);
  corrections.set("penalty_large", std::max(penalty_large, penalty_small + 1),
                  "must exceed penalty_small", &penalty_large);
  corrections.limit("uniqueness_ratio", 0.0, 99.0, defaults.uniqueness_ratio, &uniqueness_ratio);
  corrections.limit("min_contrast", 0.0, 100.0, defaults.min_contrast, &min_contrast);
  corrections.limit("disp12MaxDiff", -1, 512, &disp12_max_diff);
  corrections.limit("speckle_size", 0, 100000, &speckle_size);
  corrections.limit("speckle_range", 0, 512, &speckle_range);
  corrections.limit("threads", 0, 64, &threads);
  return corrections.take();
}

}  // namespace adaptive_grid_stereo
