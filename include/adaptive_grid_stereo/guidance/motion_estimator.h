#ifndef ADAPTIVE_GRID_STEREO_GUIDANCE_MOTION_ESTIMATOR_H
#define ADAPTIVE_GRID_STEREO_GUIDANCE_MOTION_ESTIMATOR_H

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <Eigen/Geometry>

#include "adaptive_grid_stereo/guidance/motion.h"
#include "adaptive_grid_stereo/guidance/motion_config.h"

namespace adaptive_grid_stereo {

/// One message of a motion source, as plain numbers in the axes that the source uses.
struct OdometrySample {
  double stamp = 0.0;                                      // [s]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();      // [m/s]
  Eigen::Vector3d angular_rate = Eigen::Vector3d::Zero();  // [rad/s]
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
  std::string frame;  // in which velocity and rate are given (child_frame_id)
};
struct ImuSample {
  double stamp = 0.0;                                      // [s]
  Eigen::Vector3d angular_rate = Eigen::Vector3d::Zero();  // [rad/s]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  // specific force [m/s^2]
  std::optional<Eigen::Quaterniond> orientation;           // body to world, where the source has one
  std::string frame;
};
struct VelocitySample {
  double stamp = 0.0;                                  // [s]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // [m/s], in velocity_axes
};
struct FixSample {
  double stamp = 0.0;      // [s]
  double latitude = 0.0;   // [deg]
  double longitude = 0.0;  // [deg]
  double altitude = 0.0;   // [m]
};
struct MagneticSample {
  double stamp = 0.0;                               // [s]
  Eigen::Vector3d field = Eigen::Vector3d::Zero();  // any unit, body axes
};

/// How the left optical frame sits on and turns against the frame of a motion source.
struct Mounting {
  /// Rotates a vector of the source's body frame (FLU) into the left optical frame.
  Eigen::Quaterniond optical_from_body = Eigen::Quaterniond::Identity();
  /// Rate of the optical frame against the body, in the optical frame [rad/s] (a moving gimbal).
  Eigen::Vector3d relative_rate = Eigen::Vector3d::Zero();
};

/// Given the frame of a source and a stamp [s], the camera's mounting; empty if it is not known, and
/// then `camera_rpy` of the config serves.
using MountingLookup = std::function<std::optional<Mounting>(const std::string& frame, double stamp)>;

/// Turns samples of any of the sources into forward speed, yaw rate and pitch rate at a stamp.
/// Thread safe: samples may come from several threads while another asks.
class MotionEstimator {
 public:
  explicit MotionEstimator(const MotionConfig& config);
  ~MotionEstimator();

  void setConfig(const MotionConfig& config);

  void add(const OdometrySample& sample);
  void add(const ImuSample& sample);
  void add(const VelocitySample& sample);
  void add(const FixSample& sample);
  void add(const MagneticSample& sample);

  /// The motion at `stamp` [s] plus the configured delay.
  Motion estimate(double stamp, const MountingLookup& mounting) const;

  /// Forgets all samples (a bag that starts over).
  void reset();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_GUIDANCE_MOTION_ESTIMATOR_H
