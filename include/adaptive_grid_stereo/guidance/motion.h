#ifndef ADAPTIVE_GRID_STEREO_GUIDANCE_MOTION_H
#define ADAPTIVE_GRID_STEREO_GUIDANCE_MOTION_H

#include <string>
#include <vector>

namespace adaptive_grid_stereo {

/// The numbers of a Motion at one instant between two frames.
struct MotionPoint {
  double stamp = 0.0;  // of the camera's clock [s]
  bool valid = false;
  double forward_speed = 0.0;  // [m/s]
  double yaw_rate = 0.0;       // [rad/s]
  double pitch_rate = 0.0;     // [rad/s]
};

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
  /// The motion at fixed instants (multiples of 20 ms) up to this one, since the last question.
  /// With it the hysteresis of the flight state depends on the flight alone, not on which frames
  /// were processed. Filled by whoever answers a sequence of questions; has_history = false: the
  /// frames themselves are the history.
  bool has_history = false;
  std::vector<MotionPoint> history;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_GUIDANCE_MOTION_H
