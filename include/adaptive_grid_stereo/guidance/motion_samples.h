#ifndef ADAPTIVE_GRID_STEREO_GUIDANCE_MOTION_SAMPLES_H
#define ADAPTIVE_GRID_STEREO_GUIDANCE_MOTION_SAMPLES_H

#include <optional>
#include <string>

#include <Eigen/Geometry>

namespace adaptive_grid_stereo {

/// One message of a motion source, as plain numbers in the axes that the source uses.
struct OdometrySample {
  double stamp = 0.0;                                      // [s]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();      // [m/s]
  Eigen::Vector3d angular_rate = Eigen::Vector3d::Zero();  // [rad/s]
  std::optional<Eigen::Quaterniond> orientation;           // body to world, of the pose
  std::string frame;  // in which velocity and rate are given (child_frame_id)
};
struct ImuSample {
  double stamp = 0.0;                                      // [s]
  Eigen::Vector3d angular_rate = Eigen::Vector3d::Zero();  // [rad/s]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  // specific force [m/s^2]
  std::optional<Eigen::Quaterniond> orientation;           // body to world, where there is one
  std::string frame;
};
struct VelocitySample {
  double stamp = 0.0;                                  // [s]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // [m/s], in velocity axes
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

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_GUIDANCE_MOTION_SAMPLES_H
