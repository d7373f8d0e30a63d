#ifndef ADAPTIVE_GRID_STEREO_TOOLS_THRESHOLD_TUNING_H
#define ADAPTIVE_GRID_STEREO_TOOLS_THRESHOLD_TUNING_H

#include <string>
#include <vector>

#include "adaptive_grid_stereo/guidance/guidance_config.h"
#include "adaptive_grid_stereo/guidance/motion.h"

namespace adaptive_grid_stereo {

/// What one choice of thresholds makes of a flight.
struct TuningRow {
  double sigma1 = 0.0;
  double sigma2 = 0.0;
  // Shares of the time in which the motion is known [1]; they add up to 1.
  double locked = 0.0;
  double forward = 0.0;  // alone
  double yaw = 0.0;      // alone
  double pitch = 0.0;    // alone
  double both = 0.0;
  double changes_per_minute = 0.0;
  double yaw_changes_per_minute = 0.0;    // of the side of YAW alone
  double pitch_changes_per_minute = 0.0;  // of the side of PITCH alone
  double cost = 0.0;  // mean number of paths per pixel over that of 16 everywhere [1]
};

/// Runs the flight state and the grid over a flight's motion; `points` are in order of their
/// stamps.
TuningRow tuneAt(const std::vector<MotionPoint>& points, const GuidanceConfig& config);

/// One row for each pair of sigmas.
std::vector<TuningRow> tuneGrid(const std::vector<MotionPoint>& points,
                                const GuidanceConfig& config, const std::vector<double>& sigmas);

/// Values for this aircraft, with one sentence of reason for each.
struct TuningAdvice {
  GuidanceConfig config;
  std::vector<std::string> reasons;
};

/// max_speed, max_yaw_rate and max_pitch_rate from what was reached in flight (99th percentile),
/// then the smallest sigmas with which YAW and PITCH change no more than `calm` times a minute
/// each, and whose thresholds sigma * max_rate are no less than 0.1 rad/s. Where there are none,
/// the rate and the sigma of that side stay as given. A last sentence says so if the state changes
/// more often than with `config`. Throws std::runtime_error if the aircraft never flies in the log.
TuningAdvice adviseThresholds(const std::vector<MotionPoint>& points, const GuidanceConfig& config,
                              double calm = 20.0);

/// The value below which the share q [1] of the values lies; 0 if there are none.
double quantile(std::vector<double> values, double q);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_TOOLS_THRESHOLD_TUNING_H
