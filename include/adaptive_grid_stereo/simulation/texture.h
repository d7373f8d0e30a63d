#ifndef ADAPTIVE_GRID_STEREO_SIMULATION_TEXTURE_H
#define ADAPTIVE_GRID_STEREO_SIMULATION_TEXTURE_H

#include <Eigen/Core>

#include "adaptive_grid_stereo/simulation/mesh.h"

namespace adaptive_grid_stereo {
namespace simulation {

/// Share of light that a surface reflects [0..1], by material and place; details finer than
/// `footprint` [m], a pixel's width on the surface, fade out.
float albedo(Material material, const Eigen::Vector3f& position, const Eigen::Vector3f& normal,
             float footprint);

/// Brightness of the sky [0..1] in a unit direction (ENU): a gradient with clouds, at infinity.
/// `angle` [rad] is the width of a pixel.
float skyBrightness(const Eigen::Vector3f& direction, float angle);

/// Brightness of the haze that far ground fades into [0..1].
constexpr float kHazeBrightness = 0.80f;

}  // namespace simulation
}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SIMULATION_TEXTURE_H
