#include "adaptive_grid_stereo/simulation/trajectory.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace adaptive_grid_stereo {
namespace simulation {
namespace {

// Quintic step from 0 to 1 with vanishing first and second derivatives at both ends.
double step(double u) {
  if (u <= 0.0) return 0.0;
  if (u >= 1.0) return 1.0;
  return u * u * u * (u * (6.0 * u - 15.0) + 10.0);
}

// Integral of step() from 0 to u.
double stepIntegral(double u) {
  if (u <= 0.0) return 0.0;
  if (u >= 1.0) return u - 0.5;
  return u * u * u * u * (u * (u - 3.0) + 2.5);
}

}  // namespace

void SmoothProfile::addChange(double begin, double end, double ramp, double change) {
  // The area of a pulse is amplitude * (length - ramp), its two ramps counting half each.
  pulses_.push_back({begin, end, ramp, change / (end - begin - ramp)});
}

double SmoothProfile::value(double time) const {
  double sum = initial_;
  for (const Pulse& pulse : pulses_) {
    sum += pulse.amplitude * pulse.ramp *
           (stepIntegral((time - pulse.begin) / pulse.ramp) -
            stepIntegral((time - pulse.end + pulse.ramp) / pulse.ramp));
  }
  return sum;
}

double SmoothProfile::rate(double time) const {
  double sum = 0.0;
  for (const Pulse& pulse : pulses_) {
    sum += pulse.amplitude * (step((time - pulse.begin) / pulse.ramp) -
                              step((time - pulse.end + pulse.ramp) / pulse.ramp));
  }
  return sum;
}

Trajectory::Trajectory(SmoothProfile speed, SmoothProfile climb, SmoothProfile course,
                       const Eigen::Vector3d& start, double duration)
    : speed_(std::move(speed)),
      climb_(std::move(climb)),
      course_(std::move(course)),
      duration_(duration) {
  positions_.push_back(start);
  const auto count = static_cast<int>(std::ceil(duration_ / step_)) + 1;
  for (int i = 0; i < count; ++i) {
    positions_.push_back(positions_.back() + displacement(i * step_, (i + 1) * step_));
  }
}

Eigen::Vector3d Trajectory::velocityAt(double time) const {
  const double climb = climb_.value(time);
  const double course = course_.value(time);
  return speed_.value(time) * Eigen::Vector3d(std::cos(climb) * std::cos(course),
                                              std::cos(climb) * std::sin(course), std::sin(climb));
}

Eigen::Vector3d Trajectory::accelerationAt(double time) const {
  const double climb = climb_.value(time);
  const double course = course_.value(time);
  const double cos_climb = std::cos(climb);
  const double sin_climb = std::sin(climb);
  const double cos_course = std::cos(course);
  const double sin_course = std::sin(course);
  const Eigen::Vector3d along(cos_climb * cos_course, cos_climb * sin_course, sin_climb);
  const Eigen::Vector3d by_climb(-sin_climb * cos_course, -sin_climb * sin_course, cos_climb);
  const Eigen::Vector3d by_course(-cos_climb * sin_course, cos_climb * cos_course, 0.0);
  return speed_.rate(time) * along +
         speed_.value(time) * (climb_.rate(time) * by_climb + course_.rate(time) * by_course);
}

Eigen::Matrix3d Trajectory::attitudeAt(double time) const {
  const double climb = climb_.value(time);
  const double course = course_.value(time);
  const Eigen::Vector3d forward(std::cos(climb) * std::cos(course),
                                std::cos(climb) * std::sin(course), std::sin(climb));
  const Eigen::Vector3d force = accelerationAt(time) + Eigen::Vector3d(0.0, 0.0, kGravity);
  const Eigen::Vector3d up = (force - force.dot(forward) * forward).normalized();
  Eigen::Matrix3d attitude;
  attitude << forward, up.cross(forward), up;
  return attitude;
}

Eigen::Vector3d Trajectory::displacement(double from, double to) const {
  const double middle = 0.5 * (from + to);  // Simpson's rule
  return (to - from) / 6.0 * (velocityAt(from) + 4.0 * velocityAt(middle) + velocityAt(to));
}

FlightSample Trajectory::at(double time) const {
  FlightSample sample;
  sample.time = std::min(std::max(time, 0.0), duration_);
  const auto index = static_cast<int>(sample.time / step_);
  sample.position = positions_[index] + displacement(index * step_, sample.time);
  sample.velocity = velocityAt(sample.time);
  sample.acceleration = accelerationAt(sample.time);
  const Eigen::Matrix3d attitude = attitudeAt(sample.time);
  sample.attitude = Eigen::Quaterniond(attitude).normalized();

  // R' = R [w]x; the profiles go on smoothly outside [0, duration], so the difference may too.
  constexpr double kHalfStep = 1e-4;
  const Eigen::Matrix3d derivative =
      (attitudeAt(sample.time + kHalfStep) - attitudeAt(sample.time - kHalfStep)) /
      (2.0 * kHalfStep);
  const Eigen::Matrix3d skew = attitude.transpose() * derivative;
  sample.angular_rate = 0.5 * Eigen::Vector3d(skew(2, 1) - skew(1, 2), skew(0, 2) - skew(2, 0),
                                              skew(1, 0) - skew(0, 1));
  return sample;
}

}  // namespace simulation
}  // namespace adaptive_grid_stereo
