#include "adaptive_grid_stereo/guidance/fix_track.h"

#include <GeographicLib/LocalCartesian.hpp>

namespace adaptive_grid_stereo {

std::optional<TrackVelocity> trackVelocity(const SampleBuffer<FixSample>& fixes, double time,
                                           double window, double gap_limit) {
  const std::size_t end = fixes.count(time);
  if (end < 3) return std::nullopt;
  const FixSample& newest = fixes[end - 1];
  std::size_t first = end - 1;
  // A tenth of a millisecond lets a fix that lies exactly one window back count in spite of
  // rounding.
  while (first > 0 && newest.stamp - fixes[first - 1].stamp <= window + 1e-4 &&
         fixes[first].stamp - fixes[first - 1].stamp <= gap_limit) {
    --first;
  }
  const std::size_t n = end - first;
  if (n < 3 || newest.stamp - fixes[first].stamp < 0.5 * window) return std::nullopt;

  const GeographicLib::LocalCartesian local(newest.latitude, newest.longitude, newest.altitude);
  double mean_time = 0.0;
  for (std::size_t i = first; i < end; ++i) mean_time += (fixes[i].stamp - newest.stamp) / n;
  Eigen::Vector3d slope = Eigen::Vector3d::Zero();
  double square = 0.0;
  for (std::size_t i = first; i < end; ++i) {
    Eigen::Vector3d position;
    local.Forward(fixes[i].latitude, fixes[i].longitude, fixes[i].altitude, position.x(),
                  position.y(), position.z());
    const double offset = fixes[i].stamp - newest.stamp - mean_time;
    slope += offset * position;
    square += offset * offset;
  }
  return TrackVelocity{slope / square, newest.stamp + mean_time};
}

}  // namespace adaptive_grid_stereo
