#include "adaptive_grid_stereo/guidance/motion_estimator.h"

#include <cmath>
#include <cstdio>
#include <mutex>

#include "motion_axes.h"
#include "motion_sources.h"

namespace adaptive_grid_stereo {

namespace {

bool isFinite(const Eigen::Vector3d& v) { return v.allFinite(); }

/// "odom 1.24 s old", "odom none".
template <typename Sample>
std::string ageText(const char* name, const SampleBuffer<Sample>& samples, double time) {
  const Sample* newest = samples.latest(time);
  if (newest == nullptr) return std::string(name) + " none";
  char text[64];
  std::snprintf(text, sizeof(text), "%s %.2f s old", name, time - newest->stamp);
  return text;
}

/// Mixes opinions, best first: each takes its weight of what those before it left. Returns the name
/// of the one that counts most.
template <typename Opinions, typename Get, typename Value>
const char* mix(const Opinions& opinions, const Get& get, Value* value, double* age) {
  double left = 1.0, sum = 0.0, best = 0.0;
  const char* source = "";
  Value mixed = *value;
  for (const auto& item : opinions) {
    const auto& opinion = get(item);
    const double share = left * opinion.weight;
    left -= share;
    sum += share;
    mixed += share * opinion.value;
    if (share > best) {
      best = share;
      source = opinion.source;
      *age = opinion.age;
    }
  }
  *value = mixed / sum;
  return source;
}

/// Mean rate of a camera that turns on a turning body, in the optical frame [rad/s]: from where it
/// pointed before, over the body's turn, to where it points now.
Eigen::Vector3d cameraRate(const Mounting& mounting, const Eigen::Quaterniond& body_turn) {
  const Eigen::AngleAxisd turn(mounting.optical_from_body_before * body_turn *
                               mounting.optical_from_body.conjugate());
  const double angle = turn.angle() > M_PI ? turn.angle() - 2.0 * M_PI : turn.angle();
  return turn.axis() * (angle / mounting.interval);
}

template <typename Sample>
SourceReport reportOf(const SampleBuffer<Sample>& samples, std::uint64_t invalid) {
  SourceReport report;
  report.counts = samples.counts();
  report.invalid = invalid;
  report.last_stamp = samples.empty() ? 0.0 : samples.back().stamp;
  report.period = samples.period();
  return report;
}

}  // namespace

struct MotionEstimator::Impl {
  mutable std::mutex mutex;
  MotionConfig config;
  mutable MotionSources sources;  // the attitude is computed when asked for
  std::uint64_t invalid_imu = 0, invalid_odom = 0, invalid_vel = 0, invalid_fix = 0,
                invalid_mag = 0;

  template <typename Sample>
  bool add(SampleBuffer<Sample>* samples, const Sample& sample, bool finite, std::uint64_t* invalid,
           bool moves_attitude) {
    const std::lock_guard<std::mutex> lock(mutex);
    if (!finite || !std::isfinite(sample.stamp)) {
      ++*invalid;
      return false;
    }
    const double changed_from = samples->insert(sample, config.motion_timeout);
    if (moves_attitude) sources.attitude.invalidateFrom(changed_from);
    return true;
  }

  bool speedAt(double time, Motion* motion) const;
  bool ratesAt(double time, double stamp, const MountingLookup& mounting, Motion* motion) const;
};

bool MotionEstimator::Impl::speedAt(double time, Motion* motion) const {
  const std::vector<MotionSources::Speed> speeds = sources.speeds(time, config);
  if (speeds.empty()) {
    const std::string& chosen = config.speed_source;
    motion->reason = "no forward speed within motion_timeout: ";
    if (chosen == "auto" || chosen == "odom") {
      motion->reason += ageText("odom", sources.odom, time) + (chosen == "auto" ? ", " : "");
    }
    if (chosen == "auto" || chosen == "gps_vel") {
      motion->reason += ageText("gps_vel", sources.gps_vel, time) + (chosen == "auto" ? ", " : "");
    }
    if (chosen == "auto" || chosen == "gps_fix") {
      motion->reason += ageText("gps_fix", sources.gps_fix, time);
      const FixSample* newest = sources.gps_fix.latest(time);
      if (newest != nullptr && time - newest->stamp <= config.motion_timeout) {
        motion->reason +=
            " (three fixes over half of fix_window are needed, none later than motion_timeout "
            "after the one before)";
      }
    }
    return false;
  }
  const auto self = [](const auto& item) -> const auto& { return item; };
  motion->speed_source = mix(speeds, self, &motion->forward_speed, &motion->speed_age);
  return true;
}

bool MotionEstimator::Impl::ratesAt(double time, double stamp, const MountingLookup& mounting,
                                    Motion* motion) const {
  std::vector<MotionSources::FramedRate> rates = sources.rates(time, config);
  if (rates.empty()) {
    const std::string& chosen = config.rate_source;
    motion->reason = "no rates within motion_timeout: ";
    if (chosen != "odom") motion->reason += ageText("imu", sources.imu, time);
    if (chosen == "auto") motion->reason += ", ";
    if (chosen != "imu") motion->reason += ageText("odom", sources.odom, time);
    return false;
  }
  for (MotionSources::FramedRate& item : rates) {
    const std::string& frame = config.body_frame.empty() ? item.frame : config.body_frame;
    const std::optional<Mounting> known = mounting ? mounting(frame, stamp) : std::nullopt;
    Eigen::Vector3d& rate = item.rate.value;
    if (!known) {
      rate = opticalFromBody(config.camera_rpy) *
             bodyVector(rate, config.rate_axes, RateAxes::kBodyFlu);
      continue;
    }
    if (!known->error.empty()) {
      motion->reason = known->error;
      return false;
    }
    if (known->interval > 0.0) {
      rate = cameraRate(*known, sources.turn(item.rate.source, time - known->interval, time,
                                             config.tf_axes, config));
      continue;
    }
    rate = known->optical_from_body * bodyVector(rate, config.rate_axes, config.tf_axes);
  }
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();
  const auto rateOf = [](const auto& item) -> const auto& { return item.rate; };
  motion->rate_source = mix(rates, rateOf, &rate, &motion->rate_age);
  motion->yaw_rate = -rate.y();
  motion->pitch_rate = rate.x();
  return true;
}

MotionEstimator::MotionEstimator(const MotionConfig& config) : impl_(std::make_unique<Impl>()) {
  setConfig(config);
}

MotionEstimator::~MotionEstimator() = default;

void MotionEstimator::setConfig(const MotionConfig& config) {
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  impl_->config = config;
  impl_->config.validate();
  impl_->sources.attitude.clear();
}

bool MotionEstimator::add(const OdometrySample& sample) {
  const bool finite = isFinite(sample.velocity) && isFinite(sample.angular_rate) &&
                      (!sample.orientation || sample.orientation->coeffs().allFinite());
  return impl_->add(&impl_->sources.odom, sample, finite, &impl_->invalid_odom, true);
}

bool MotionEstimator::add(const ImuSample& sample) {
  const bool finite = isFinite(sample.angular_rate) && isFinite(sample.acceleration) &&
                      (!sample.orientation || sample.orientation->coeffs().allFinite());
  return impl_->add(&impl_->sources.imu, sample, finite, &impl_->invalid_imu, true);
}

bool MotionEstimator::add(const VelocitySample& sample) {
  return impl_->add(&impl_->sources.gps_vel, sample, isFinite(sample.velocity), &impl_->invalid_vel,
                    true);
}

bool MotionEstimator::add(const FixSample& sample) {
  const bool finite = std::abs(sample.latitude) <= 90.0 && std::abs(sample.longitude) <= 540.0 &&
                      std::isfinite(sample.altitude);
  return impl_->add(&impl_->sources.gps_fix, sample, finite, &impl_->invalid_fix, false);
}

bool MotionEstimator::add(const MagneticSample& sample) {
  return impl_->add(&impl_->sources.mag, sample, isFinite(sample.field), &impl_->invalid_mag, true);
}

Motion MotionEstimator::estimate(double stamp, const MountingLookup& mounting) const {
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  Motion motion;
  const double time = stamp + impl_->config.motion_delay;
  if (!std::isfinite(time)) {
    motion.reason = "the stamp asked for is not a number";
    return motion;
  }
  if (impl_->speedAt(time, &motion) && impl_->ratesAt(time, stamp, mounting, &motion)) {
    // Finite samples can be so large that what is computed from them is not.
    motion.valid = std::isfinite(motion.forward_speed) && std::isfinite(motion.yaw_rate) &&
                   std::isfinite(motion.pitch_rate);
    if (motion.valid) return motion;
    motion.reason =
        "speed or rates are beyond all numbers: " + motion.speed_source + ", " + motion.rate_source;
  }
  Motion none;
  none.reason = motion.reason;
  return none;
}

bool MotionEstimator::ready(double stamp) const {
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  return impl_->sources.ready(stamp + impl_->config.motion_delay, impl_->config);
}

EstimatorReport MotionEstimator::report() const {
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  const MotionSources& sources = impl_->sources;
  EstimatorReport report;
  report.imu = reportOf(sources.imu, impl_->invalid_imu);
  report.odom = reportOf(sources.odom, impl_->invalid_odom);
  report.gps_vel = reportOf(sources.gps_vel, impl_->invalid_vel);
  report.gps_fix = reportOf(sources.gps_fix, impl_->invalid_fix);
  report.mag = reportOf(sources.mag, impl_->invalid_mag);
  if (!sources.imu.empty() &&
      !sources.imuIsUpright(sources.imu.back().stamp, impl_->config.rate_axes)) {
    report.warning =
        std::string(
            "imu: gravity is not along its up axis, so it does not sit on the body as rate_axes ") +
        toString(impl_->config.rate_axes) + " says; its orientation is not used";
  }
  return report;
}

void MotionEstimator::startOver(double stamp) {
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  impl_->sources.startOver(stamp);
}

void MotionEstimator::awaitNoLonger() {
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  impl_->sources.awaitNoLonger();
}

}  // namespace adaptive_grid_stereo
