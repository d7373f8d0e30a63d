#include "adaptive_grid_stereo/guidance/guidance_config.h"

#include "src/common/corrections.h"

namespace adaptive_grid_stereo {

namespace {

/// The largest of 4, 8 and 16 that is not above `paths`; 4 if there is none.
int legalPaths(int paths) { return paths >= 16 ? 16 : paths >= 8 ? 8 : 4; }

}  // namespace

std::vector<std::string> GuidanceConfig::validate() {
  const GuidanceConfig defaults;
  Corrections corrections;
  corrections.limit("lock_speed", 0.0, 100.0, defaults.lock_speed, &lock_speed);
  corrections.limit("max_speed", 0.1, 1000.0, defaults.max_speed, &max_speed);
  corrections.limit("max_yaw_rate", 0.01, 100.0, defaults.max_yaw_rate, &max_yaw_rate);
  corrections.limit("max_pitch_rate", 0.01, 100.0, defaults.max_pitch_rate, &max_pitch_rate);
  corrections.limit("sigma1", 0.0, 1.0, defaults.sigma1, &sigma1);
  corrections.limit("sigma2", 0.0, 1.0, defaults.sigma2, &sigma2);
  corrections.limit("hysteresis", 0.0, 1.0, defaults.hysteresis, &hysteresis);
  corrections.limit("min_dwell_time", 0.0, 10.0, defaults.min_dwell_time, &min_dwell_time);
  corrections.limit("grid_gain", 0.0, 100.0, defaults.grid_gain, &grid_gain);
  corrections.limit("center_min_fraction", 0.0, 1.0, defaults.center_min_fraction,
                    &center_min_fraction);

  const std::string legal = "paths are 4, 8 or 16";
  corrections.set("paths_focus", legalPaths(paths_focus), legal, &paths_focus);
  corrections.set("paths_near", legalPaths(paths_near), legal, &paths_near);
  corrections.set("paths_far", legalPaths(paths_far), legal, &paths_far);
  corrections.set("paths_unknown", legalPaths(paths_unknown), legal, &paths_unknown);
  corrections.set("paths_near", std::min(paths_near, paths_focus), "no more than paths_focus",
                  &paths_near);
  corrections.set("paths_far", std::min(paths_far, paths_near), "no more than paths_near",
                  &paths_far);
  return corrections.take();
}

}  // namespace adaptive_grid_stereo
