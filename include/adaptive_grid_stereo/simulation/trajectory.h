#ifndef ADAPTIVE_GRID_STEREO_SIMULATION_TRAJECTORY_H
#define ADAPTIVE_GRID_STEREO_SIMULATION_TRAJECTORY_H

#include <vector>

#include <Eigen/Geometry>

namespace adaptive_grid_stereo {
namespace simulation {

/// Gravity in the world frame (ENU) [m/s^2].
constexpr double kGravity = 9.80665;

/// A quantity that changes smoothly: its rate is a sum of pulses, each of which rises over `ramp`,
/// holds `amplitude` and falls over `ramp` again, twice continuously differentiable.
class SmoothProfile {
 public:
  explicit SmoothProfile(double initial = 0.0) : initial_(initial) {}

  /// Adds a pulse in [begin, end] [s] that changes the value by `change` in all;
  /// 0 < ramp [s] <= (end - begin) / 2.
  void addChange(double begin, double end, double ramp, double change);

  double value(double time) const;
  double rate(double time) const;

 private:
  struct Pulse {
    double begin, end, ramp, amplitude;
  };
  double initial_;
  std::vector<Pulse> pulses_;
};

/// Where the aircraft is and how it moves at one instant. World: ENU [m]; body: FLU.
struct FlightSample {
  double time = 0.0;                                             // since the start [s]
  Eigen::Vector3d position = Eigen::Vector3d::Zero();            // world [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();            // world [m/s]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();        // world, without gravity [m/s^2]
  Eigen::Quaterniond attitude = Eigen::Quaterniond::Identity();  // body to world
  Eigen::Vector3d angular_rate = Eigen::Vector3d::Zero();        // body [rad/s]

  Eigen::Vector3d bodyVelocity() const { return attitude.conjugate() * velocity; }
  /// What an accelerometer feels, in the body frame [m/s^2].
  Eigen::Vector3d specificForce() const {
    return attitude.conjugate() * (acceleration + Eigen::Vector3d(0.0, 0.0, kGravity));
  }
};

/// A flight in still air, given by speed, climb angle and course over time.
///
/// Everything else follows. The nose points along the path; position is the integral of the
/// velocity; the bank is that of a coordinated turn: the body's up axis is the part of the specific
/// force across the path, so that nothing pulls sideways (level turn: tan(bank) = v * course rate /
/// g); body rates are the derivative of the attitude. Immutable, so thread safe.
class Trajectory {
 public:
  /// speed [m/s] >= 0, climb angle [rad] within +-90 degrees, course [rad] from east, left
  /// positive; `start` is the position at time 0, `duration` > 0 [s].
  Trajectory(SmoothProfile speed, SmoothProfile climb, SmoothProfile course,
             const Eigen::Vector3d& start, double duration);

  double duration() const { return duration_; }

  /// The sample at `time` [s]; times outside [0, duration] are clamped.
  FlightSample at(double time) const;

 private:
  Eigen::Vector3d velocityAt(double time) const;
  Eigen::Vector3d accelerationAt(double time) const;
  Eigen::Matrix3d attitudeAt(double time) const;
  Eigen::Vector3d displacement(double from, double to) const;

  SmoothProfile speed_;
  SmoothProfile climb_;
  SmoothProfile course_;
  double duration_;
  double step_ = 0.01;
  std::vector<Eigen::Vector3d> positions_;  // at multiples of step_
};

}  // namespace simulation
}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SIMULATION_TRAJECTORY_H
