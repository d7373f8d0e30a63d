#ifndef ADAPTIVE_GRID_STEREO_GUIDANCE_ATTITUDE_FILTER_H
#define ADAPTIVE_GRID_STEREO_GUIDANCE_ATTITUDE_FILTER_H

#include <cstddef>
#include <deque>
#include <functional>
#include <optional>

#include <Eigen/Geometry>

#include "adaptive_grid_stereo/guidance/motion_samples.h"
#include "adaptive_grid_stereo/guidance/sample_buffer.h"

namespace adaptive_grid_stereo {

/// Orientation of the body (FLU) in the earth's axes (ENU), and the gyro's bias.
struct Attitude {
  double stamp = 0.0;                                               // [s]
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();  // body to ENU
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();              // [rad/s]
};

/// What one step of the filter sees, all in body axes (FLU).
struct AttitudeInput {
  double stamp = 0.0;            // [s]
  Eigen::Vector3d angular_rate;  // [rad/s]
  Eigen::Vector3d acceleration;  // specific force [m/s^2]
  Eigen::Vector3d field;         // any unit
  double speed = 0.0;            // along the flight path [m/s]; 0 if unknown
};

/// Orientation from gravity and magnetic field alone; empty if one of them cannot be told (free
/// fall, field along gravity). declination [rad]: true north to magnetic north, east positive.
std::optional<Attitude> initialAttitude(const AttitudeInput& input, double declination);

/// One step of the explicit complementary filter of Mahony, Hamel and Pflimlin (2008). An
/// accelerometer in a coordinated turn feels level, so gravity's pull on the estimate fades as rate
/// x speed grows, and the gyro carries it through the turn. Gains were chosen on a real fixed-wing
/// log and on computed coordinated turns.
Attitude attitudeStep(const Attitude& last, const AttitudeInput& input, double declination);

/// Runs the filter along the samples as they are asked for, and runs anew from where samples came
/// late, so that the result does not depend on the order of arrival. Not thread safe.
class AttitudeTrack {
 public:
  /// Gives the filter's input for an Imu sample; empty where there is no magnetic field.
  using InputLookup = std::function<std::optional<AttitudeInput>(const ImuSample&)>;

  /// The attitude at the latest Imu sample up to `time` [s].
  std::optional<Attitude> at(double time, const SampleBuffer<ImuSample>& imu,
                             const InputLookup& input, double declination);

  /// Forgets what was computed from `stamp` [s] on.
  void invalidateFrom(double stamp);
  void clear() { attitudes_.clear(); }

 private:
  std::deque<Attitude> attitudes_;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_GUIDANCE_ATTITUDE_FILTER_H
