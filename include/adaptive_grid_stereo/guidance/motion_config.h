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
  /// "body_flu", "body_frd", "enu", "ned": axes of the odometry's linear velocity, and of gps/vel
  /// unless gps_velocity_axes says otherwise.
  VelocityAxes velocity_axes = VelocityAxes::kBodyFlu;
  /// Axes of gps/vel by the same names, or "auto": velocity_axes if those are enu or ned, else enu,
  /// since a GPS receiver knows nothing of the body.
  std::string gps_velocity_axes = "auto";
  /// "body_flu", "body_frd": axes of angular rates, accelerations and orientations of imu and odom.
  RateAxes rate_axes = RateAxes::kBodyFlu;
  /// "body_flu", "body_frd": axes of the body frames in TF. ROS says FLU (REP 103); AirSim's tree
  /// is FRD throughout.
  RateAxes tf_axes = RateAxes::kBodyFlu;
  /// Frame in which the rates are given, where the frame names in the messages are wrong; empty:
  /// the message's own frame.
  std::string body_frame;
  /// Roll, pitch, yaw of a forward-looking camera against the body (FLU: yaw left, pitch down, roll
  /// right positive) [rad], -2 pi..2 pi, where TF has nothing; zero looks forward, level.
  std::array<double, 3> camera_rpy{{0.0, 0.0, 0.0}};
  /// Constant offset from camera stamps to motion stamps [s], -1..1.
  double motion_delay = 0.0;
  /// Samples older than this are stale [s], 0.01..10.
  double motion_timeout = 0.5;
  /// Time constant of the low-pass on the rates [s], 0..2; 0: no filter.
  double rate_filter_time = 0.1;
  /// Length of flight over which position fixes are differenced [s], 0.2..10.
  double fix_window = 2.0;
  /// True north to magnetic north, east positive [rad], -pi..pi; for the estimated heading.
  double magnetic_declination = 0.0;
  /// Longest wait of the frame worker for motion samples that are still on their way [s] of wall
  /// time, 0..1.
  double motion_wait = 0.03;

  /// Brings every value into its legal range and returns one sentence per value that was changed.
  std::vector<std::string> validate();
};

/// Names as in the parameters; the parsers throw std::invalid_argument, listing the legal names.
const char* toString(VelocityAxes axes);
const char* toString(RateAxes axes);
constexpr char kVelocityAxesNames[] = "body_flu, body_frd, enu or ned";
constexpr char kRateAxesNames[] = "body_flu or body_frd";
VelocityAxes velocityAxesFromString(const std::string& name);
RateAxes rateAxesFromString(const std::string& name);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_GUIDANCE_MOTION_CONFIG_H
