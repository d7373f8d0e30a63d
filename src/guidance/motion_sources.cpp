#include "motion_sources.h"

#include <algorithm>
#include <cmath>

#include "adaptive_grid_stereo/guidance/fix_track.h"
#include "adaptive_grid_stereo/guidance/rate_filter.h"
#include "motion_axes.h"

namespace adaptive_grid_stereo {

namespace {

/// The field changes slowly in the body, so an old one still serves [s].
constexpr double kMagneticTimeout = 1.0;
/// Time over which the mean acceleration must point up [s]: in coordinated flight it always does,
/// at whatever bank, so if it does not the Imu does not sit on the body as declared.
constexpr double kUprightWindow = 5.0;
constexpr double kLeastGravity = 3.0;  // [m/s^2]
/// Below this GPS velocities are taken as the median of the last three [m/s].
constexpr double kSlow = 1.0;
/// Smallest weight of a fresh source, so that it serves when it is the only one.
constexpr double kSmallestWeight = 1e-6;

bool isEarth(VelocityAxes axes) { return axes == VelocityAxes::kEnu || axes == VelocityAxes::kNed; }

Eigen::Vector3d toEnu(const Eigen::Vector3d& velocity, VelocityAxes axes) {
  return axes == VelocityAxes::kNed ? swapEnuNed(velocity) : velocity;
}

/// Falls from 1 to 0 over the second half of the timeout, and rises over as long after the source
/// came (back), so that neither makes a jump.
template <typename Sample>
double weightAt(const SampleBuffer<Sample>& samples, double time, double timeout) {
  const double fade = 0.5 * timeout;
  std::size_t i = samples.count(time) - 1;
  const double age = time - samples[i].stamp;
  double since = samples[i].stamp;
  while (time - since < fade) {
    if (i == 0 || samples[i].stamp - samples[i - 1].stamp > timeout) break;
    since = samples[--i].stamp;
  }
  const double rise = std::min(1.0, (time - since) / fade);
  const double fall = std::min(1.0, (timeout - age) / fade);
  return std::max(kSmallestWeight, std::min(rise, fall));
}

template <typename Sample>
bool isFresh(const SampleBuffer<Sample>& samples, double time, double timeout) {
  const Sample* newest = samples.latest(time);
  return newest != nullptr && time - newest->stamp <= timeout;
}

bool allowed(const std::string& chosen, const char* source) {
  return chosen == "auto" || chosen == source;
}

template <typename Sample>
bool delivered(const SampleBuffer<Sample>& samples, double time, double timeout) {
  if (samples.empty()) return !samples.awaited();
  return !isDue(time - samples.back().stamp, samples.period(), timeout);
}

}  // namespace

VelocityAxes gpsVelocityAxes(const MotionConfig& config) {
  if (config.gps_velocity_axes != "auto") return velocityAxesFromString(config.gps_velocity_axes);
  return isEarth(config.velocity_axes) ? config.velocity_axes : VelocityAxes::kEnu;
}

void MotionSources::startOver(double stamp) {
  imu.startOver(stamp);
  odom.startOver(stamp);
  gps_vel.startOver(stamp);
  gps_fix.startOver(stamp);
  mag.startOver(stamp);
  attitude.clear();
}

void MotionSources::awaitNoLonger() {
  imu.awaitNoLonger();
  odom.awaitNoLonger();
  gps_vel.awaitNoLonger();
  gps_fix.awaitNoLonger();
}

std::optional<AttitudeInput> MotionSources::attitudeInput(const ImuSample& sample,
                                                          const MotionConfig& config) {
  const MagneticSample* field = mag.latest(sample.stamp);
  if (field == nullptr || sample.stamp - field->stamp > kMagneticTimeout) return std::nullopt;
  AttitudeInput input;
  input.stamp = sample.stamp;
  input.angular_rate = bodyVector(sample.angular_rate, config.rate_axes, RateAxes::kBodyFlu);
  input.acceleration = bodyVector(sample.acceleration, config.rate_axes, RateAxes::kBodyFlu);
  input.field = bodyVector(field->field, config.rate_axes, RateAxes::kBodyFlu);
  if (isFresh(gps_vel, sample.stamp, 1.0)) {
    input.speed = gps_vel.latest(sample.stamp)->velocity.norm();
  } else if (isFresh(odom, sample.stamp, 1.0)) {
    input.speed = odom.latest(sample.stamp)->velocity.norm();
  }
  return input;
}

bool MotionSources::imuIsUpright(double time, RateAxes axes) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  std::size_t n = 0;
  for (std::size_t i = imu.count(time); i > 0 && time - imu[i - 1].stamp <= kUprightWindow; --i) {
    sum += bodyVector(imu[i - 1].acceleration, axes, RateAxes::kBodyFlu);
    ++n;
  }
  // Some sources leave the acceleration empty: nothing to contradict the orientation then.
  if (n == 0 || sum.norm() < kLeastGravity * static_cast<double>(n)) return true;
  return sum.z() > 0.5 * sum.norm();
}

std::optional<Eigen::Vector3d> MotionSources::forwardAxisAt(double time,
                                                            const MotionConfig& config) {
  if (!isFresh(imu, time, config.motion_timeout) || !imuIsUpright(time, config.rate_axes)) {
    return std::nullopt;
  }
  const std::size_t last = imu.count(time) - 1;
  if (!imu[last].orientation) {
    const auto input = [&](const ImuSample& sample) { return attitudeInput(sample, config); };
    const auto estimated = attitude.at(time, imu, input, config.magnetic_declination);
    if (!estimated || time - estimated->stamp > config.motion_timeout) return std::nullopt;
    return forwardAxis(estimated->orientation, RateAxes::kBodyFlu);
  }
  Eigen::Quaterniond orientation = *imu[last].orientation;
  if (last + 1 < imu.size() && imu[last + 1].orientation) {
    const double interval = imu[last + 1].stamp - imu[last].stamp;
    if (interval <= kInterpolationReach) {
      orientation =
          orientation.slerp((time - imu[last].stamp) / interval, *imu[last + 1].orientation);
    }
  }
  return forwardAxis(orientation, config.rate_axes);
}

double MotionSources::projected(const Eigen::Vector3d& velocity_enu, double time,
                                const MotionConfig& config) {
  if (const auto forward = forwardAxisAt(time, config)) return velocity_enu.dot(*forward);
  return velocity_enu.head<2>().norm();
}

double MotionSources::speedOf(const OdometrySample& sample, const MotionConfig& config) {
  if (!isEarth(config.velocity_axes)) return sample.velocity.x();
  const Eigen::Vector3d velocity = toEnu(sample.velocity, config.velocity_axes);
  if (sample.orientation) return velocity.dot(forwardAxis(*sample.orientation, config.rate_axes));
  return projected(velocity, sample.stamp, config);
}

double MotionSources::speedOf(const VelocitySample& sample, const MotionConfig& config) {
  const VelocityAxes axes = gpsVelocityAxes(config);
  if (!isEarth(axes)) return sample.velocity.x();
  return projected(toEnu(sample.velocity, axes), sample.stamp, config);
}

double MotionSources::gpsSpeed(double time, const MotionConfig& config) {
  const std::size_t end = gps_vel.count(time);
  const double speed = speedOf(gps_vel[end - 1], config);
  if (std::abs(speed) >= kSlow || end < 3) return speed;
  // A standing receiver's velocity has peaks of one sample that look like a start.
  const double before = speedOf(gps_vel[end - 2], config);
  const double earlier = speedOf(gps_vel[end - 3], config);
  return std::max(std::min(speed, before), std::min(std::max(speed, before), earlier));
}

double MotionSources::odometrySpeed(double time, const MotionConfig& config) {
  const std::size_t last = odom.count(time) - 1;
  const double speed = speedOf(odom[last], config);
  if (last + 1 >= odom.size()) return speed;
  const double interval = odom[last + 1].stamp - odom[last].stamp;
  if (interval > kInterpolationReach) return speed;
  const double share = (time - odom[last].stamp) / interval;
  return speed + share * (speedOf(odom[last + 1], config) - speed);
}

std::vector<MotionSources::Speed> MotionSources::speeds(double time, const MotionConfig& config) {
  const double timeout = config.motion_timeout;
  std::vector<Speed> result;
  if (allowed(config.speed_source, "odom") && isFresh(odom, time, timeout)) {
    result.push_back({"odom", odometrySpeed(time, config), time - odom.latest(time)->stamp,
                      weightAt(odom, time, timeout)});
  }
  if (allowed(config.speed_source, "gps_vel") && isFresh(gps_vel, time, timeout)) {
    const VelocitySample& sample = *gps_vel.latest(time);
    result.push_back(
        {"gps_vel", gpsSpeed(time, config), time - sample.stamp, weightAt(gps_vel, time, timeout)});
  }
  if (allowed(config.speed_source, "gps_fix") && isFresh(gps_fix, time, timeout)) {
    const auto track = trackVelocity(gps_fix, time, config.fix_window, timeout);
    if (track) {
      result.push_back({"gps_fix", projected(track->velocity, track->stamp, config),
                        time - gps_fix.latest(time)->stamp, weightAt(gps_fix, time, timeout)});
    }
  }
  return result;
}

std::vector<MotionSources::FramedRate> MotionSources::rates(double time,
                                                            const MotionConfig& config) const {
  const double timeout = config.motion_timeout;
  std::vector<FramedRate> result;
  const auto addFrom = [&](const char* name, const auto& samples) {
    if (!allowed(config.rate_source, name) || !isFresh(samples, time, timeout)) return;
    const auto& newest = *samples.latest(time);
    result.push_back({{name, filteredRate(samples, time, config.rate_filter_time, timeout),
                       time - newest.stamp, weightAt(samples, time, timeout)},
                      newest.frame});
  };
  addFrom("imu", imu);
  addFrom("odom", odom);
  return result;
}

Eigen::Quaterniond MotionSources::turn(const std::string& source, double from, double to,
                                       RateAxes axes, const MotionConfig& config) const {
  Eigen::Quaterniond turn =
      source == "imu" ? turnBetween(imu, from, to) : turnBetween(odom, from, to);
  turn.vec() = bodyVector(turn.vec(), config.rate_axes, axes);
  return turn;
}

bool MotionSources::ready(double time, const MotionConfig& config) const {
  const double timeout = config.motion_timeout;
  if (!delivered(imu, time, timeout)) return false;
  // A source that fades in or out leaves a share to the next one.
  const auto suffices = [&](const char* name, const auto& samples) {
    return allowed(config.speed_source, name) && isFresh(samples, time, timeout) &&
           weightAt(samples, time, timeout) >= 1.0;
  };
  const bool odom_speed = allowed(config.speed_source, "odom");
  const bool odom_rate = allowed(config.rate_source, "odom") &&
                         !(isFresh(imu, time, timeout) && weightAt(imu, time, timeout) >= 1.0);
  if ((odom_speed || odom_rate) && !delivered(odom, time, timeout)) return false;
  if (suffices("odom", odom)) return true;
  if (allowed(config.speed_source, "gps_vel") && !delivered(gps_vel, time, timeout)) return false;
  if (suffices("gps_vel", gps_vel)) return true;
  return !allowed(config.speed_source, "gps_fix") || delivered(gps_fix, time, timeout);
}

}  // namespace adaptive_grid_stereo
