#ifndef ADAPTIVE_GRID_STEREO_GUIDANCE_RATE_FILTER_H
#define ADAPTIVE_GRID_STEREO_GUIDANCE_RATE_FILTER_H

#include <cmath>

#include <Eigen/Geometry>

#include "adaptive_grid_stereo/guidance/sample_buffer.h"

namespace adaptive_grid_stereo {

/// One step of a first-order low-pass with time constant tau [s], exact for an input that runs in a
/// straight line from `from` to `to` within dt [s].
inline Eigen::Vector3d lowPassStep(const Eigen::Vector3d& output, const Eigen::Vector3d& from,
                                   const Eigen::Vector3d& to, double dt, double tau) {
  if (tau <= 0.0) return to;
  if (dt <= 0.0) return output;
  const Eigen::Vector3d lag = (to - from) * (tau / dt);
  return to - lag + (output - from + lag) * std::exp(-dt / tau);
}

/// The angular rate of a source at `time` [s] as it is, in the source's own axes. Needs a sample up
/// to `time`.
template <typename Sample>
Eigen::Vector3d rateAt(const SampleBuffer<Sample>& samples, double time) {
  const std::size_t last = samples.count(time) - 1;
  const Eigen::Vector3d& rate = samples[last].angular_rate;
  if (last + 1 >= samples.size()) return rate;
  const double interval = samples[last + 1].stamp - samples[last].stamp;
  if (interval > kInterpolationReach) return rate;
  const double share = (time - samples[last].stamp) / interval;
  return rate + share * (samples[last + 1].angular_rate - rate);
}

/// The angular rate of a source at `time` [s], in the source's own axes, low-passed with time
/// constant tau [s] (0: none). Needs a sample up to `time`. Causal but for the one sample that ends
/// the interval in which `time` lies, if that is no longer than kInterpolationReach. Depends on
/// nothing but the samples, so it does not matter in which order they came. The filter starts anew
/// after a gap longer than gap_limit [s].
template <typename Sample>
Eigen::Vector3d filteredRate(const SampleBuffer<Sample>& samples, double time, double tau,
                             double gap_limit) {
  const std::size_t last = samples.count(time) - 1;
  const Eigen::Vector3d now = rateAt(samples, time);
  if (tau <= 0.0) return now;

  // After eight time constants what lies before counts less than 0.04 %.
  const double start = time - 8.0 * tau;
  std::size_t first = last;
  while (first > 0 && samples[first - 1].stamp >= start &&
         samples[first].stamp - samples[first - 1].stamp <= gap_limit) {
    --first;
  }
  Eigen::Vector3d output = samples[first].angular_rate;
  for (std::size_t i = first; i < last; ++i) {
    output = lowPassStep(output, samples[i].angular_rate, samples[i + 1].angular_rate,
                         samples[i + 1].stamp - samples[i].stamp, tau);
  }
  return lowPassStep(output, samples[last].angular_rate, now, time - samples[last].stamp, tau);
}

/// How the body turned from time `from` to time `to` [s], as the rotation from its later to its
/// earlier axes. Needs a sample up to `to`; before the first sample the body is taken to have
/// turned as there.
template <typename Sample>
Eigen::Quaterniond turnBetween(const SampleBuffer<Sample>& samples, double from, double to) {
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  const auto advance = [&](const Eigen::Vector3d& first, const Eigen::Vector3d& last, double dt) {
    const Eigen::Vector3d angle = 0.5 * dt * (first + last);
    if (angle.norm() > 0.0) turn = turn * Eigen::AngleAxisd(angle.norm(), angle.normalized());
  };
  double time = from;
  std::size_t next = samples.count(from);
  Eigen::Vector3d rate = next > 0 ? rateAt(samples, from) : samples[0].angular_rate;
  for (; next < samples.size() && samples[next].stamp <= to; ++next) {
    advance(rate, samples[next].angular_rate, samples[next].stamp - time);
    time = samples[next].stamp;
    rate = samples[next].angular_rate;
  }
  advance(rate, rateAt(samples, to), to - time);
  return turn;
}

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_GUIDANCE_RATE_FILTER_H
