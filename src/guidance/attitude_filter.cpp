#include "adaptive_grid_stereo/guidance/attitude_filter.h"

#include <algorithm>
#include <cmath>

namespace adaptive_grid_stereo {

namespace {

constexpr double kGravity = 9.81;         // [m/s^2]
constexpr double kTiltGain = 0.3;         // [1/s] pull of gravity
constexpr double kHeadingGain = 0.5;      // [1/s] pull of the magnetic field
constexpr double kBiasGain = 0.01;        // [1/s^2]
constexpr double kTurnFade = 0.4;         // share of gravity at which a turn's pull counts 1/e
constexpr double kLargestBias = 0.1;      // [rad/s]
constexpr double kLongestStep = 0.5;      // [s] across which the rates can be integrated
constexpr std::size_t kCapacity = 16384;  // attitudes kept

/// How much the accelerometer is to be believed: 1 in straight and steady flight, towards 0 where
/// the specific force is not gravity's, or where the path bends (rate x speed, across the forward
/// axis).
double tiltWeight(const AttitudeInput& input, const Eigen::Vector3d& rate) {
  const double excess = std::abs(input.acceleration.norm() - kGravity) / kGravity;
  const double bend = rate.tail<2>().norm() * input.speed / (kTurnFade * kGravity);
  return std::max(0.0, 1.0 - 2.0 * excess) * std::exp(-bend * bend);
}

Eigen::Vector3d magneticNorth(double declination) {
  return {std::sin(declination), std::cos(declination), 0.0};
}

}  // namespace

std::optional<Attitude> initialAttitude(const AttitudeInput& input, double declination) {
  const Eigen::Vector3d& up = input.acceleration;
  const Eigen::Vector3d east = input.field.cross(up);
  if (up.norm() < 0.3 * kGravity || east.norm() < 0.05 * input.field.norm() * up.norm()) {
    return std::nullopt;
  }
  Eigen::Matrix3d magnetic_from_body;
  magnetic_from_body.row(0) = east.normalized();
  magnetic_from_body.row(1) = up.cross(east).normalized();
  magnetic_from_body.row(2) = up.normalized();
  Attitude attitude;
  attitude.stamp = input.stamp;
  // Magnetic north lies clockwise of true north by the declination.
  attitude.orientation = Eigen::AngleAxisd(-declination, Eigen::Vector3d::UnitZ()) *
                         Eigen::Quaterniond(magnetic_from_body);
  return attitude;
}

Attitude attitudeStep(const Attitude& last, const AttitudeInput& input, double declination) {
  const double dt = input.stamp - last.stamp;
  const Eigen::Vector3d rate = input.angular_rate - last.gyro_bias;
  const Eigen::Quaterniond body_from_world = last.orientation.conjugate();

  Eigen::Vector3d tilt_error = Eigen::Vector3d::Zero();
  const double weight = tiltWeight(input, rate);
  if (weight > 0.0) {
    const Eigen::Vector3d expected = body_from_world * Eigen::Vector3d::UnitZ();
    tilt_error = weight * input.acceleration.normalized().cross(expected);
  }

  Eigen::Vector3d heading_error = Eigen::Vector3d::Zero();
  Eigen::Vector3d field = last.orientation * input.field;
  field.z() = 0.0;
  if (field.norm() > 0.05 * input.field.norm()) {
    const double error = field.normalized().cross(magneticNorth(declination)).z();
    heading_error = body_from_world * Eigen::Vector3d(0.0, 0.0, error);
  }

  Attitude next;
  next.stamp = input.stamp;
  next.gyro_bias = last.gyro_bias - kBiasGain * dt * (tilt_error + heading_error);
  next.gyro_bias = next.gyro_bias.cwiseMax(-kLargestBias).cwiseMin(kLargestBias);
  const Eigen::Vector3d turn = dt * (rate + kTiltGain * tilt_error + kHeadingGain * heading_error);
  next.orientation = last.orientation;
  if (turn.norm() > 0.0) {
    next.orientation = next.orientation * Eigen::AngleAxisd(turn.norm(), turn.normalized());
  }
  next.orientation.normalize();
  return next;
}

std::optional<Attitude> AttitudeTrack::at(double time, const SampleBuffer<ImuSample>& imu,
                                          const InputLookup& input, double declination) {
  std::size_t next = attitudes_.empty() ? 0 : imu.count(attitudes_.back().stamp);
  const std::size_t end = imu.count(time);
  for (; next < end; ++next) {
    const std::optional<AttitudeInput> now = input(imu[next]);
    if (!now) continue;
    if (!attitudes_.empty() && now->stamp - attitudes_.back().stamp <= kLongestStep) {
      attitudes_.push_back(attitudeStep(attitudes_.back(), *now, declination));
    } else if (const auto initial = initialAttitude(*now, declination)) {
      attitudes_.push_back(*initial);
    }
    if (attitudes_.size() > kCapacity) attitudes_.pop_front();
  }
  const auto later = [](double value, const Attitude& attitude) { return value < attitude.stamp; };
  const auto place = std::upper_bound(attitudes_.begin(), attitudes_.end(), time, later);
  if (place == attitudes_.begin()) return std::nullopt;
  return *(place - 1);
}

void AttitudeTrack::invalidateFrom(double stamp) {
  while (!attitudes_.empty() && attitudes_.back().stamp >= stamp) attitudes_.pop_back();
}

}  // namespace adaptive_grid_stereo
