#ifndef ADAPTIVE_GRID_STEREO_GUIDANCE_RATE_FILTER_H
#define ADAPTIVE_GRID_STEREO_GUIDANCE_RATE_FILTER_H

#include <cmath>

#include <Eigen/Core>

#include "adaptive_grid_stereo/guidance/sample_buffer.h"

namespace adaptive_grid_stereo {

/// Samples at most so far apart are joined by a straight line [s]; otherwise the earlier one holds
/// until the later one comes. A live node can afford to wait so long for the later one.
constexpr double kInterpolationReach = 0.025;

/// One step of a first-order low-pass with time constant tau [s], exact for an input that runs in a
/// straight line from `from` to `to` within dt [s].
inline Eigen::Vector3d lowPassStep(const Eigen::Vector3d& output, const Eigen::Vector3d& from,
                                   const Eigen::Vector3d& to, double dt, double tau) {
  if (tau <= 0.0) return to;
  if (dt <= 0.0) return output;
  const Eigen::Vector3d lag = (to - from) * (tau / dt);
  return to - lag + (output - from + lag) * std::exp(-dt / tau);
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
  Eigen::Vector3d now = samples[last].angular_rate;
  if (last + 1 < samples.size()) {
    const double interval = samples[last + 1].stamp - samples[last].stamp;
    if (interval <= kInterpolationReach) {
      const double share = (time - samples[last].stamp) / interval;
      now += share * (samples[last + 1].angular_rate - samples[last].angular_rate);
    }
  }
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

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_GUIDANCE_RATE_FILTER_H
