#include "adaptive_grid_stereo/simulation/sensors.h"

#include <GeographicLib/LocalCartesian.hpp>

#include "adaptive_grid_stereo/simulation/noise.h"

namespace adaptive_grid_stereo {
namespace simulation {
namespace {

// One stream of random numbers for each kind of noise.
enum Stream : std::uint64_t {
  kGyro = 1,
  kGyroBias,
  kAccelerometer,
  kAccelerometerBias,
  kAttitude,
  kOdometryVelocity,
  kOdometryRate,
  kOdometryPosition,
  kGpsVelocity,
  kGpsPosition,
  kGpsWander,
  kMagnetic
};

}  // namespace

Eigen::Vector3d Sensors::white(double deviation, std::uint64_t stream, std::uint64_t index) const {
  const double scale = config_.noise_scale * deviation;
  return {scale * gaussianRandom(config_.seed, 3 * stream, index),
          scale * gaussianRandom(config_.seed, 3 * stream + 1, index),
          scale * gaussianRandom(config_.seed, 3 * stream + 2, index)};
}

Eigen::Vector3d Sensors::wander(double deviation, double period, std::uint64_t stream,
                                double time) const {
  // Value noise has a standard deviation of about 0.45 along a line.
  const double scale = config_.noise_scale * deviation / 0.45;
  Eigen::Vector3d offset;
  for (int axis = 0; axis < 3; ++axis) {
    const auto seed = static_cast<std::uint32_t>(hashBits(config_.seed, 3 * stream + axis, 0));
    offset[axis] = scale * valueNoise(static_cast<float>(time / period), 0.5f, seed);
  }
  return offset;
}

Eigen::Quaterniond Sensors::wanderingAttitude(const FlightSample& truth) const {
  const Eigen::Vector3d error = wander(config_.attitude_wander, 8.0, kAttitude, truth.time);
  const double angle = error.norm();
  if (angle == 0.0) return truth.attitude;
  return (truth.attitude * Eigen::AngleAxisd(angle, error / angle)).normalized();
}

ImuReading Sensors::imu(const FlightSample& truth, std::uint64_t index) const {
  ImuReading reading;
  reading.angular_rate = truth.angular_rate + white(config_.gyro_bias, kGyroBias, 0) +
                         white(config_.gyro_noise, kGyro, index);
  reading.specific_force = truth.specificForce() +
                           white(config_.accelerometer_bias, kAccelerometerBias, 0) +
                           white(config_.accelerometer_noise, kAccelerometer, index);
  reading.attitude = wanderingAttitude(truth);
  return reading;
}

OdometryReading Sensors::odometry(const FlightSample& truth, std::uint64_t index) const {
  OdometryReading reading;
  reading.position =
      truth.position + wander(config_.position_wander, 10.0, kOdometryPosition, truth.time);
  reading.attitude = wanderingAttitude(truth);
  reading.velocity = truth.bodyVelocity() + white(config_.velocity_noise, kOdometryVelocity, index);
  // The autopilot has filtered its gyro already.
  reading.angular_rate = truth.angular_rate + white(0.5 * config_.gyro_noise, kOdometryRate, index);
  return reading;
}

GeodeticPosition Sensors::gpsPosition(const FlightSample& truth, std::uint64_t index) const {
  Eigen::Vector3d error = wander(config_.gps_position_wander, 12.0, kGpsWander, truth.time) +
                          white(config_.gps_position_noise, kGpsPosition, index);
  error.z() *= 2.0;
  const Eigen::Vector3d position = truth.position + error;
  const GeographicLib::LocalCartesian world(kWorldOrigin.latitude, kWorldOrigin.longitude,
                                            kWorldOrigin.altitude);
  GeodeticPosition reading{};
  world.Reverse(position.x(), position.y(), position.z(), reading.latitude, reading.longitude,
                reading.altitude);
  return reading;
}

Eigen::Vector3d Sensors::gpsVelocity(const FlightSample& truth, std::uint64_t index) const {
  return truth.velocity + white(config_.gps_velocity_noise, kGpsVelocity, index);
}

Eigen::Vector3d Sensors::magneticField(const FlightSample& truth, std::uint64_t index) const {
  return truth.attitude.conjugate() * kMagneticField +
         white(config_.magnetic_noise, kMagnetic, index);
}

}  // namespace simulation
}  // namespace adaptive_grid_stereo
