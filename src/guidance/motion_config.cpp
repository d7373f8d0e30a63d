#include "adaptive_grid_stereo/guidance/motion_config.h"

#include <algorithm>
#include <stdexcept>

#include "src/common/corrections.h"

namespace adaptive_grid_stereo {

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr VelocityAxes kVelocityAxes[] = {VelocityAxes::kBodyFlu, VelocityAxes::kBodyFrd,
                                          VelocityAxes::kEnu, VelocityAxes::kNed};
constexpr RateAxes kRateAxes[] = {RateAxes::kBodyFlu, RateAxes::kBodyFrd};

/// Replaces a name that is not in the list by the first of the list.
void checkName(const char* parameter, const std::vector<std::string>& legal, std::string* name,
               Corrections* corrections) {
  if (std::find(legal.begin(), legal.end(), *name) != legal.end()) return;
  std::string names;
  for (const std::string& item : legal) names += (names.empty() ? "" : ", ") + item;
  corrections->set(parameter, legal.front(), "expected one of " + names, name);
}

}  // namespace

const char* toString(VelocityAxes axes) {
  switch (axes) {
    case VelocityAxes::kBodyFrd:
      return "body_frd";
    case VelocityAxes::kEnu:
      return "enu";
    case VelocityAxes::kNed:
      return "ned";
    case VelocityAxes::kBodyFlu:
      break;
  }
  return "body_flu";
}

const char* toString(RateAxes axes) { return axes == RateAxes::kBodyFrd ? "body_frd" : "body_flu"; }

VelocityAxes velocityAxesFromString(const std::string& name) {
  for (const VelocityAxes axes : kVelocityAxes) {
    if (name == toString(axes)) return axes;
  }
  throw std::invalid_argument("velocity axes '" + name + "' are unknown, expected " +
                              kVelocityAxesNames);
}

RateAxes rateAxesFromString(const std::string& name) {
  for (const RateAxes axes : kRateAxes) {
    if (name == toString(axes)) return axes;
  }
  throw std::invalid_argument("body axes '" + name + "' are unknown, expected " + kRateAxesNames);
}

std::vector<std::string> MotionConfig::validate() {
  const MotionConfig defaults;
  Corrections corrections;
  checkName("speed_source", {"auto", "odom", "gps_vel", "gps_fix"}, &speed_source, &corrections);
  checkName("rate_source", {"auto", "imu", "odom"}, &rate_source, &corrections);
  checkName("gps_velocity_axes", {"auto", "body_flu", "body_frd", "enu", "ned"}, &gps_velocity_axes,
            &corrections);
  for (double& angle : camera_rpy) corrections.limit("camera_rpy", -2 * kPi, 2 * kPi, 0.0, &angle);
  corrections.limit("motion_delay", -1.0, 1.0, defaults.motion_delay, &motion_delay);
  corrections.limit("motion_timeout", 0.01, 10.0, defaults.motion_timeout, &motion_timeout);
  corrections.limit("rate_filter_time", 0.0, 2.0, defaults.rate_filter_time, &rate_filter_time);
  corrections.limit("fix_window", 0.2, 10.0, defaults.fix_window, &fix_window);
  corrections.limit("magnetic_declination", -kPi, kPi, defaults.magnetic_declination,
                    &magnetic_declination);
  corrections.limit("motion_wait", 0.0, 1.0, defaults.motion_wait, &motion_wait);
  return corrections.take();
}

}  // namespace adaptive_grid_stereo
