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
/// A threshold sigma * max_rate below this [rad/s] is no turn, but the wobble of a calm flight.
constexpr double kSmallestThreshold = 0.1;
/// Half of it is that threshold, so that there are sigmas left to choose from [rad/s].
constexpr double kSmallestMaxRate = 2.0 * kSmallestThreshold;
constexpr double kSigmaStep = 0.05, kLargestSigma = 0.9;

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

template <typename... Values>
std::string sentence(const char* format, Values... values) {
  char text[256];
  std::snprintf(text, sizeof(text), format, values...);
  return text;
}

/// One of the two turns: its parameters, and the changes that they cause.
struct Axis {
  const char* verb;
  const char* max_rate_name;
  const char* sigma_name;
  double GuidanceConfig::*max_rate;
  double GuidanceConfig::*sigma;
  double TuningRow::*changes;
};
constexpr Axis kYaw = {"turns",
                       "max_yaw_rate",
                       "sigma1",
                       &GuidanceConfig::max_yaw_rate,
                       &GuidanceConfig::sigma1,
                       &TuningRow::yaw_changes_per_minute};
constexpr Axis kPitch = {"pitches",
                         "max_pitch_rate",
                         "sigma2",
                         &GuidanceConfig::max_pitch_rate,
                         &GuidanceConfig::sigma2,
                         &TuningRow::pitch_changes_per_minute};

/// Chooses the axis' parameters by the absolute rates of the flight; leaves the given ones where
/// no threshold is calm.
void adviseAxis(const std::vector<MotionPoint>& points, const Axis& axis,
                const std::vector<double>& rates, double calm, TuningAdvice* advice) {
  const double reached = quantile(rates, 0.99);
  GuidanceConfig trial = advice->config;
  const double max_rate = std::max(kSmallestMaxRate, roundUp(reached, 0.05));
  trial.*axis.max_rate = max_rate;
  for (int step = 2; kSigmaStep * step < kLargestSigma + 1e-9; ++step) {
    const double sigma = kSigmaStep * step;
    if (sigma * max_rate < kSmallestThreshold - 1e-9) continue;
    trial.*axis.sigma = sigma;
    const double changes = tuneAt(points, trial).*axis.changes;
    if (changes > calm) continue;
    advice->config = trial;
    advice->reasons.push_back(axis.max_rate_name +
                              sentence(" %.2f: 99 %% of the flight %s slower than %.2f rad/s",
                                       max_rate, axis.verb, reached));
    advice->reasons.push_back(
        axis.sigma_name + sentence(" %.2f: the smallest from %.1f rad/s on with no more than one "
                                   "change of side in a few seconds (%.1f a minute)",
                                   sigma, kSmallestThreshold, changes));
    return;
  }
  advice->reasons.push_back(
      std::string(axis.max_rate_name) + " and " + axis.sigma_name +
      sentence(
          ": as given, since with each threshold from %.2f to %.2f rad/s the side changes more "
          "than %.1f times a minute; a larger rate_filter_time may calm it",
          kSmallestThreshold, kLargestSigma * max_rate, calm));
}

/// Says so if the advice makes the state change more often than the given parameters do.
void compareWithGiven(const std::vector<MotionPoint>& points, const GuidanceConfig& given,
                      TuningAdvice* advice) {
  const double before = tuneAt(points, given).changes_per_minute;
  const double after = tuneAt(points, advice->config).changes_per_minute;
  if (after <= before) return;
  advice->reasons.push_back(
      sentence("the state changes more often than with the parameters given, %.1f against %.1f "
               "times a minute; keep those, or give a smaller --calm, if that is too often",
               after, before));
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
  advice.config.max_speed = roundUp(speed, 0.5);
  advice.reasons.push_back(sentence("max_speed %.1f: 99 %% of the flight is slower than %.1f m/s",
                                    advice.config.max_speed, speed));
  adviseAxis(points, kYaw, yaw_rates, calm, &advice);
  adviseAxis(points, kPitch, pitch_rates, calm, &advice);
  compareWithGiven(points, config, &advice);
  return advice;
}

}  // namespace adaptive_grid_stereo
