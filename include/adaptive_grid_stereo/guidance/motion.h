#ifndef ADAPTIVE_GRID_STEREO_GUIDANCE_MOTION_H
#define ADAPTIVE_GRID_STEREO_GUIDANCE_MOTION_H

#include <string>

namespace adaptive_grid_stereo {

/// How the aircraft and its left camera move at one instant.
struct Motion {
  /// False if speed or rates were missing or older than `motion_timeout`; the numbers are then 0.
  bool valid = false;
  /// Along the aircraft's own forward axis [m/s]; negative when flying backwards.
  double forward_speed = 0.0;
  /// Turn of the camera to the left positive [rad/s]: -omega_y in the left optical frame.
  double yaw_rate = 0.0;
  /// Turn of the camera upwards positive [rad/s]: +omega_x in the left optical frame.
  double pitch_rate = 0.0;
  /// Which sources served, e.g. "odom", "gps_vel", "gps_fix" and "imu", "odom"; empty if none did.
  std::string speed_source;
  std::string rate_source;
  /// Age of the newest sample used, relative to the stamp asked for [s].
  double speed_age = 0.0;
  double rate_age = 0.0;
  /// In words why `valid` is false; empty otherwise.
  std::string reason;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_GUIDANCE_MOTION_H
