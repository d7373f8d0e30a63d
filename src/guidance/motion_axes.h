#ifndef ADAPTIVE_GRID_STEREO_SRC_GUIDANCE_MOTION_AXES_H
#define ADAPTIVE_GRID_STEREO_SRC_GUIDANCE_MOTION_AXES_H

#include <Eigen/Geometry>

#include "adaptive_grid_stereo/guidance/motion_config.h"

namespace adaptive_grid_stereo {

/// Changes a body vector between forward-left-up and forward-right-down; its own inverse.
inline Eigen::Vector3d swapFluFrd(const Eigen::Vector3d& v) { return {v.x(), -v.y(), -v.z()}; }

/// A body vector given in `from` axes, in `to` axes.
inline Eigen::Vector3d bodyVector(const Eigen::Vector3d& v, RateAxes from, RateAxes to) {
  return from == to ? v : swapFluFrd(v);
}

/// Changes an earth vector between east-north-up and north-east-down; its own inverse.
inline Eigen::Vector3d swapEnuNed(const Eigen::Vector3d& v) { return {v.y(), v.x(), -v.z()}; }

/// The forward axis in ENU of a body with this orientation. Stacks that speak of FRD bodies give
/// their orientation against NED, those that speak of FLU against ENU.
inline Eigen::Vector3d forwardAxis(const Eigen::Quaterniond& orientation, RateAxes axes) {
  const Eigen::Vector3d forward = orientation * Eigen::Vector3d::UnitX();
  return axes == RateAxes::kBodyFrd ? swapEnuNed(forward) : forward;
}

/// Rotates a body vector (FLU) into the optical frame (z forward, x right, y down) of a camera that
/// sits on the body with roll, pitch, yaw [rad] (yaw left, then pitch down, then roll right
/// positive, as FLU axes have it).
inline Eigen::Quaterniond opticalFromBody(const std::array<double, 3>& rpy) {
  const Eigen::Quaterniond body_from_camera = Eigen::AngleAxisd(rpy[2], Eigen::Vector3d::UnitZ()) *
                                              Eigen::AngleAxisd(rpy[1], Eigen::Vector3d::UnitY()) *
                                              Eigen::AngleAxisd(rpy[0], Eigen::Vector3d::UnitX());
  Eigen::Matrix3d optical_from_camera;
  optical_from_camera << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  return Eigen::Quaterniond(optical_from_camera) * body_from_camera.conjugate();
}

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SRC_GUIDANCE_MOTION_AXES_H
