#ifndef ADAPTIVE_GRID_STEREO_SIMULATION_SENSORS_H
#define ADAPTIVE_GRID_STEREO_SIMULATION_SENSORS_H

#include <cstdint>

#include <Eigen/Geometry>

#include "adaptive_grid_stereo/simulation/trajectory.h"

namespace adaptive_grid_stereo {
namespace simulation {

/// Standard deviations of one reading, as of a small autopilot.
struct SensorConfig {
  std::uint64_t seed = 1;
  /// Scales all of the following; 0: perfect sensors.
  double noise_scale = 1.0;
  double gyro_noise = 0.006;          // [rad/s]
  double gyro_bias = 0.002;           // constant over a flight [rad/s]
  double accelerometer_noise = 0.08;  // [m/s^2]
  double accelerometer_bias = 0.04;   // [m/s^2]
  double attitude_wander = 0.008;     // slow error of the attitude filter [rad]
  double velocity_noise = 0.05;       // of the odometry [m/s]
  double position_wander = 0.3;       // slow, of the odometry [m]
  double gps_velocity_noise = 0.10;   // [m/s]
  double gps_position_noise = 0.08;   // from fix to fix [m]
  double gps_position_wander = 0.8;   // slow, horizontal; vertical twice that [m]
  double magnetic_noise = 0.25e-6;    // [T]
};

/// Readings at one instant; the position of the sensors is the body's origin. Body: FLU, world:
/// ENU.
struct ImuReading {
  Eigen::Vector3d angular_rate;    // body [rad/s]
  Eigen::Vector3d specific_force;  // body [m/s^2]
  Eigen::Quaterniond attitude;     // body to world
};
struct OdometryReading {
  Eigen::Vector3d position;      // world [m]
  Eigen::Quaterniond attitude;   // body to world
  Eigen::Vector3d velocity;      // body [m/s]
  Eigen::Vector3d angular_rate;  // body [rad/s]
};
struct GeodeticPosition {
  double latitude;   // WGS 84 [deg]
  double longitude;  // [deg]
  double altitude;   // above the ellipsoid [m]
};

/// Where the world's origin lies on the earth, and the magnetic field there (ENU) [T].
constexpr GeodeticPosition kWorldOrigin{47.40, 8.55, 480.0};
const Eigen::Vector3d kMagneticField{1.1e-6, 21.5e-6, -43.0e-6};

/// Turns the truth into readings. `index` counts a sensor's readings: each has noise of its own,
/// and asking twice gives the same. Thread safe.
class Sensors {
 public:
  explicit Sensors(const SensorConfig& config) : config_(config) {}

  ImuReading imu(const FlightSample& truth, std::uint64_t index) const;
  OdometryReading odometry(const FlightSample& truth, std::uint64_t index) const;
  GeodeticPosition gpsPosition(const FlightSample& truth, std::uint64_t index) const;
  Eigen::Vector3d gpsVelocity(const FlightSample& truth, std::uint64_t index) const;  // world [m/s]
  Eigen::Vector3d magneticField(const FlightSample& truth, std::uint64_t index) const;  // body [T]

  const SensorConfig& config() const { return config_; }

 private:
  Eigen::Vector3d white(double deviation, std::uint64_t stream, std::uint64_t index) const;
  Eigen::Vector3d wander(double deviation, double period, std::uint64_t stream, double time) const;
  Eigen::Quaterniond wanderingAttitude(const FlightSample& truth) const;

  SensorConfig config_;
};

}  // namespace simulation
}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SIMULATION_SENSORS_H
