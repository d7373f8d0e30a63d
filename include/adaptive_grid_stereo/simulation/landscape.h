#ifndef ADAPTIVE_GRID_STEREO_SIMULATION_LANDSCAPE_H
#define ADAPTIVE_GRID_STEREO_SIMULATION_LANDSCAPE_H

#include <cstdint>
#include <vector>

#include "adaptive_grid_stereo/simulation/mesh.h"
#include "adaptive_grid_stereo/simulation/trajectory.h"

namespace adaptive_grid_stereo {
namespace simulation {

/// Terrain, trees, bushes, poles and houses around a flight, none of them in its way: the aircraft
/// keeps at least `clearance` [m] from everything but the runway.
struct LandscapeConfig {
  std::uint64_t seed = 1;
  float clearance = 3.0f;
};

/// The same flight and config give the same meshes.
std::vector<Mesh> makeLandscape(const Trajectory& flight, const LandscapeConfig& config);

}  // namespace simulation
}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SIMULATION_LANDSCAPE_H
