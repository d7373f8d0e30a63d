#ifndef ADAPTIVE_GRID_STEREO_SIMULATION_TERRAIN_H
#define ADAPTIVE_GRID_STEREO_SIMULATION_TERRAIN_H

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "adaptive_grid_stereo/simulation/mesh.h"
#include "adaptive_grid_stereo/simulation/trajectory.h"

namespace adaptive_grid_stereo {
namespace simulation {

/// Rolling ground under a flight: a runway on a plateau where the flight starts on the ground, a
/// valley with relief along the path, hills around the horizon. It always stays below the aircraft.
class Terrain {
 public:
  Terrain(const Trajectory& flight, std::uint64_t seed);

  /// Height of the ground [m] at east x, north y [m].
  float height(float x, float y) const;

  /// Distance from the flight's ground track [m], capped at `limit`; the aircraft's height [m]
  /// where it passes nearest goes to `aircraft_height`.
  float distanceFromPath(float x, float y, float limit, float* aircraft_height) const;

  /// The ground as triangles: fine near the path, coarser towards the horizon.
  Mesh mesh() const;

  /// Corners of the flight's ground track [m].
  const Eigen::Vector2f& lowerCorner() const { return lower_; }
  const Eigen::Vector2f& upperCorner() const { return upper_; }

 private:
  float runwayShare(float x, float y) const;

  std::uint32_t seed_;
  bool has_runway_;
  Eigen::Vector2f lower_;
  Eigen::Vector2f upper_;
  std::vector<Eigen::Vector3f> path_;
};

}  // namespace simulation
}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SIMULATION_TERRAIN_H
