#ifndef ADAPTIVE_GRID_STEREO_GUIDANCE_FIX_TRACK_H
#define ADAPTIVE_GRID_STEREO_GUIDANCE_FIX_TRACK_H

#include <optional>

#include <Eigen/Core>

#include "adaptive_grid_stereo/guidance/motion_samples.h"
#include "adaptive_grid_stereo/guidance/sample_buffer.h"

namespace adaptive_grid_stereo {

struct TrackVelocity {
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // east, north, up [m/s]
  double stamp = 0.0;                                  // for which it holds best [s]
};

/// Velocity from the position fixes of the last `window` seconds up to `time` [s]: the
/// least-squares straight line through them in a local cartesian frame. Differences of neighbouring
/// fixes would carry the receiver's noise. Empty with fewer than three fixes, with fixes that span
/// less than half the window, or across a gap longer than gap_limit [s].
std::optional<TrackVelocity> trackVelocity(const SampleBuffer<FixSample>& fixes, double time,
                                           double window, double gap_limit);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_GUIDANCE_FIX_TRACK_H
