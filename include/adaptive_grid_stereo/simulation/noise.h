#ifndef ADAPTIVE_GRID_STEREO_SIMULATION_NOISE_H
#define ADAPTIVE_GRID_STEREO_SIMULATION_NOISE_H

#include <cstdint>

#include <Eigen/Core>

namespace adaptive_grid_stereo {
namespace simulation {

/// Random numbers without state: the same (seed, stream, index) gives the same number, whatever was
/// asked before, on every machine and in every thread.
std::uint64_t hashBits(std::uint64_t seed, std::uint64_t stream, std::uint64_t index);

/// Uniform in [0, 1).
double uniformRandom(std::uint64_t seed, std::uint64_t stream, std::uint64_t index);

/// Standard normal distribution (Box-Muller).
double gaussianRandom(std::uint64_t seed, std::uint64_t stream, std::uint64_t index);

/// Smooth noise in [-1, 1] with one feature per unit length.
float valueNoise(float x, float y, std::uint32_t seed);
float valueNoise(const Eigen::Vector3f& point, std::uint32_t seed);

/// Sum of octaves of value noise, from `wavelength` [m] down in halves, each `persistence` times
/// weaker than the one before, in [-1, 1]. Octaves too fine for `footprint` [m], the width of a
/// pixel on the surface, fade out, so that a texture looks the same from near and far without
/// aliasing.
struct FractalNoise {
  std::uint32_t seed = 0;
  float wavelength = 1.0f;
  int octaves = 4;
  float persistence = 0.5f;

  float operator()(float x, float y, float footprint) const;
  float operator()(const Eigen::Vector3f& point, float footprint) const;
};

}  // namespace simulation
}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SIMULATION_NOISE_H
