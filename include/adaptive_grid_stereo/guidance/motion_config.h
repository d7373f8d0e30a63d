#ifndef ADAPTIVE_GRID_STEREO_GUIDANCE_MOTION_CONFIG_H
#define ADAPTIVE_GRID_STEREO_GUIDANCE_MOTION_CONFIG_H

#include <array>
#include <string>
#include <vector>

namespace adaptive_grid_stereo {

/// Axes in which a source gives its vectors.
enum class VelocityAxes { kBodyFlu, kBodyFrd, kEnu, kNed };
enum class RateAxes { kBodyFlu, kBodyFrd };

/// Parameters of the motion estimate, with the package's defaults.
struct MotionConfig {
  /// "auto", or one source by name: speed "odom", "gps_vel", "gps_fix"; rates "imu", "odom".
  std::string speed_source = "auto";
  std::string rate_source = "auto";
  /// "body_flu", "body_frd", "enu", "ned": axes of the odometry's linear velocity and of gps/vel.
  VelocityAxes velocity_axes = VelocityAxes::kBodyFlu;
  /// "body_flu", "body_frd": axes of angular rates, accelerations and orientations of imu and odom.
  RateAxes rate_axes = RateAxes::kBodyFlu;
  /// Roll, pitch, yaw of a forward-looking camera against the body (FLU) [rad], where TF has nothing;
  /// zero looks forward, level.
  std::array<double, 3> camera_rpy{{0.0, 0.0, 0.0}};
  /// Constant offset from camera stamps to motion stamps [s].
  double motion_delay = 0.0;
  /// Samples older than this are stale [s], > 0.
  double motion_timeout = 0.5;
  /// Time constant of the low-pass on the rates [s], >= 0; 0: no filter.
  double rate_filter_time = 0.1;

  /// Brings every value into its legal range and returns one sentence per value that was changed.
  std::vector<std::string> validate();
};

/// Names as in the parameters; the parsers throw std::invalid_argument, listing the legal names.
const char* toString(VelocityAxes axes);
const char* toString(RateAxes axes);
VelocityAxes velocityAxesFromString(const std::string& name);
RateAxes rateAxesFromString(const std::string& name);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_GUIDANCE_MOTION_CONFIG_H
