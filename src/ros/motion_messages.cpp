#include "motion_messages.h"

#include <cmath>

namespace adaptive_grid_stereo {

namespace {

Eigen::Vector3d vectorOf(const geometry_msgs::Vector3& v) { return {v.x, v.y, v.z}; }

bool stamped(const std_msgs::Header& header, std::string* error) {
  if (!header.stamp.isZero()) return true;
  *error = "header.stamp is zero; the driver must stamp its messages";
  return false;
}

bool finite(const Eigen::Vector3d& v, const char* field, std::string* error) {
  if (v.allFinite()) return true;
  *error = std::string(field) + " holds NaN or inf";
  return false;
}

std::optional<Eigen::Quaterniond> orientationOf(const geometry_msgs::Quaternion& q) {
  const Eigen::Quaterniond orientation(q.w, q.x, q.y, q.z);
  const double length = orientation.norm();
  if (!std::isfinite(length) || std::abs(length - 1.0) > 0.1) return std::nullopt;
  return orientation.normalized();
}

}  // namespace

std::optional<ImuSample> toSample(const sensor_msgs::Imu& message, std::string* error) {
  ImuSample sample;
  sample.stamp = message.header.stamp.toSec();
  sample.frame = message.header.frame_id;
  sample.angular_rate = vectorOf(message.angular_velocity);
  sample.acceleration = vectorOf(message.linear_acceleration);
  if (!stamped(message.header, error) || !finite(sample.angular_rate, "angular_velocity", error)) {
    return std::nullopt;
  }
  // The acceleration only serves the attitude filter, so a bad one does not cost the rates.
  if (!sample.acceleration.allFinite()) sample.acceleration.setZero();
  // By the message's definition, covariance[0] = -1 says that there is no orientation.
  if (message.orientation_covariance[0] != -1.0)
    sample.orientation = orientationOf(message.orientation);
  return sample;
}

std::optional<OdometrySample> toSample(const nav_msgs::Odometry& message, std::string* error) {
  OdometrySample sample;
  sample.stamp = message.header.stamp.toSec();
  sample.frame = message.child_frame_id;
  sample.velocity = vectorOf(message.twist.twist.linear);
  sample.angular_rate = vectorOf(message.twist.twist.angular);
  sample.orientation = orientationOf(message.pose.pose.orientation);
  if (!stamped(message.header, error) || !finite(sample.velocity, "twist.linear", error) ||
      !finite(sample.angular_rate, "twist.angular", error)) {
    return std::nullopt;
  }
  return sample;
}

std::optional<VelocitySample> toSample(const geometry_msgs::TwistStamped& message,
                                       std::string* error) {
  VelocitySample sample;
  sample.stamp = message.header.stamp.toSec();
  sample.velocity = vectorOf(message.twist.linear);
  if (!stamped(message.header, error) || !finite(sample.velocity, "twist.linear", error)) {
    return std::nullopt;
  }
  return sample;
}

std::optional<FixSample> toSample(const sensor_msgs::NavSatFix& message, std::string* error) {
  FixSample sample;
  sample.stamp = message.header.stamp.toSec();
  sample.latitude = message.latitude;
  sample.longitude = message.longitude;
  // Receivers without a height give NaN there; the horizontal speed is what counts.
  sample.altitude = std::isfinite(message.altitude) ? message.altitude : 0.0;
  if (!stamped(message.header, error)) return std::nullopt;
  if (message.status.status < sensor_msgs::NavSatStatus::STATUS_FIX) {
    *error = "status.status is below STATUS_FIX: the receiver has no position yet";
    return std::nullopt;
  }
  if (!(std::abs(message.latitude) <= 90.0) || !(std::abs(message.longitude) <= 360.0)) {
    *error = "latitude or longitude is out of range or NaN";
    return std::nullopt;
  }
  return sample;
}

std::optional<MagneticSample> toSample(const sensor_msgs::MagneticField& message,
                                       std::string* error) {
  MagneticSample sample;
  sample.stamp = message.header.stamp.toSec();
  sample.field = vectorOf(message.magnetic_field);
  if (!stamped(message.header, error) || !finite(sample.field, "magnetic_field", error)) {
    return std::nullopt;
  }
  return sample;
}

}  // namespace adaptive_grid_stereo
