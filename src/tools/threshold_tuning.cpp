#include "threshold_tuning.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "adaptive_grid_stereo/guidance/adaptive_grid.h"
#include "adaptive_grid_stereo/guidance/flight_state.h"

namespace adaptive_grid_stereo {

namespace {

constexpr int kWidth = 900, kHeight = 600;  // [px], any size whose cells are not coarse
constexpr double kSmallestMaxRate = 0.1;    // [rad/s]

Motion motionOf(const MotionPoint& point) {
  Motion motion;
  motion.valid = point.valid;
  motion.forward_speed = point.forward_speed;
  motion.yaw_rate = point.yaw_rate;
  motion.pitch_rate = point.pitch_rate;
  return motion;
}

double* shareOf(const FlightState& state, TuningRow* row) {
  const bool yaw = state.yaw != YawSide::kNone, pitch = state.pitch != PitchSide::kNone;
  if (state.locked) return &row->locked;
  if (yaw && pitch) return &row->both;
  if (yaw) return &row->yaw;
  return pitch ? &row->pitch : &row->forward;
}

double roundUp(double value, double step) { return std::ceil(value / step - 1e-9) * step; }

std::string sentence(const char* format, double a, double b, double c = 0.0) {
  char text[256];
  std::snprintf(text, sizeof(text), format, a, b, c);
  return text;
}

/// The smallest of the sigmas that is calm enough, else the calmest; `changes` per minute of each.
std::size_t calmest(const std::vector<double>& changes, double calm) {
  for (std::size_t i = 0; i < changes.size(); ++i) {
    if (changes[i] <= calm) return i;
  }
  return static_cast<std::size_t>(std::min_element(changes.begin(), changes.end()) -
                                  changes.begin());
}

}  // namespace

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0.0;
  const auto index = static_cast<std::size_t>(q * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), values.begin() + static_cast<long>(index), values.end());
  return values[index];
}

TuningRow tuneAt(const std::vector<MotionPoint>& points, const GuidanceConfig& config) {
  TuningRow row;
  row.sigma1 = config.sigma1;
  row.sigma2 = config.sigma2;
  FlightStateMachine machine;
  FlightState last;
  double known = 0.0;
  for (const MotionPoint& point : points) {
    const FlightState state = machine.update(motionOf(point), point.stamp, config);
    if (state.motion_known) {
      if (last.motion_known) {
        row.changes_per_minute += state != last;
        row.yaw_changes_per_minute += state.yaw != last.yaw;
        row.pitch_changes_per_minute += state.pitch != last.pitch;
      }
      *shareOf(state, &row) += 1.0;
      known += 1.0;
      row.cost +=
          meanPaths(makePathPlan(state, point.forward_speed, config, kWidth, kHeight)) / 16.0;
    }
    last = state;
  }
  if (known == 0.0) return row;
  const double minutes = (points.back().stamp - points.front().stamp) / 60.0;
  for (double* share : {&row.locked, &row.forward, &row.yaw, &row.pitch, &row.both, &row.cost}) {
    *share /= known;
  }
  for (double* changes :
       {&row.changes_per_minute, &row.yaw_changes_per_minute, &row.pitch_changes_per_minute}) {
    *changes = minutes > 0.0 ? *changes / minutes : 0.0;
  }
  return row;
}

std::vector<TuningRow> tuneGrid(const std::vector<MotionPoint>& points,
                                const GuidanceConfig& config, const std::vector<double>& sigmas) {
  std::vector<TuningRow> rows;
  GuidanceConfig trial = config;
  for (const double sigma1 : sigmas) {
    for (const double sigma2 : sigmas) {
      trial.sigma1 = sigma1;
      trial.sigma2 = sigma2;
      rows.push_back(tuneAt(points, trial));
    }
  }
  return rows;
}

TuningAdvice adviseThresholds(const std::vector<MotionPoint>& points, const GuidanceConfig& config,
                              double calm) {
  std::vector<double> speeds, yaw_rates, pitch_rates;
  for (const MotionPoint& point : points) {
    if (!point.valid || point.forward_speed <= config.lock_speed) continue;
    speeds.push_back(point.forward_speed);
    yaw_rates.push_back(std::abs(point.yaw_rate));
    pitch_rates.push_back(std::abs(point.pitch_rate));
  }
  if (speeds.empty()) {
    throw std::runtime_error("the aircraft never moves faster than lock_speed " +
                             std::to_string(config.lock_speed) +
                             " m/s in this log, or its motion is never known: nothing to tune by "
                             "(bag_check says what is wrong with a log)");
  }
  TuningAdvice advice;
  advice.config = config;
  const double speed = quantile(speeds, 0.99);
  const double yaw = quantile(yaw_rates, 0.99), pitch = quantile(pitch_rates, 0.99);
  advice.config.max_speed = roundUp(speed, 0.5);
  advice.config.max_yaw_rate = std::max(kSmallestMaxRate, roundUp(yaw, 0.05));
  advice.config.max_pitch_rate = std::max(kSmallestMaxRate, roundUp(pitch, 0.05));
  advice.reasons.push_back(sentence("max_speed %.1f: 99 %% of the flight is slower than %.1f m/s",
                                    advice.config.max_speed, speed));
  advice.reasons.push_back(
      sentence("max_yaw_rate %.2f: 99 %% of the flight turns slower than %.2f rad/s",
               advice.config.max_yaw_rate, yaw));
  advice.reasons.push_back(
      sentence("max_pitch_rate %.2f: 99 %% of the flight pitches slower than %.2f rad/s",
               advice.config.max_pitch_rate, pitch));

  std::vector<double> sigmas, yaw_changes, pitch_changes;
  GuidanceConfig trial = advice.config;
  for (double sigma = 0.1; sigma < 0.91; sigma += 0.05) {
    trial.sigma1 = trial.sigma2 = sigma;
    const TuningRow row = tuneAt(points, trial);
    sigmas.push_back(sigma);
    yaw_changes.push_back(row.yaw_changes_per_minute);
    pitch_changes.push_back(row.pitch_changes_per_minute);
  }
  const std::size_t i = calmest(yaw_changes, calm), j = calmest(pitch_changes, calm);
  advice.config.sigma1 = sigmas[i];
  advice.config.sigma2 = sigmas[j];
  const char* calm_enough =
      "sigma%.0f %.2f: the smallest with no more than "
      "one change of side in a few seconds (%.1f a minute)";
  const char* calmest_there =
      "sigma%.0f %.2f: none is calm, this one changes the least (%.1f a minute)";
  advice.reasons.push_back(sentence(yaw_changes[i] <= calm ? calm_enough : calmest_there, 1.0,
                                    sigmas[i], yaw_changes[i]));
  advice.reasons.push_back(sentence(pitch_changes[j] <= calm ? calm_enough : calmest_there, 2.0,
                                    sigmas[j], pitch_changes[j]));
  return advice;
}

}  // namespace adaptive_grid_stereo
