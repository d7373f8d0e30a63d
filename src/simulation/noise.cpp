#include "adaptive_grid_stereo/simulation/noise.h"

#include <algorithm>
#include <cmath>

namespace adaptive_grid_stereo {
namespace simulation {
namespace {

// Finalizer of splitmix64 (Steele, Lea, Flood 2014).
std::uint64_t mix(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ull;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

// Small multiply-xorshift hash of a lattice point; value in [-1, 1].
float latticeValue(std::int32_t x, std::int32_t y, std::int32_t z, std::uint32_t seed) {
  std::uint32_t h = static_cast<std::uint32_t>(x) * 0x8da6b343u ^
                    static_cast<std::uint32_t>(y) * 0xd8163841u ^
                    static_cast<std::uint32_t>(z) * 0xcb1ab31fu ^ seed * 0x9e3779b1u;
  h ^= h >> 16;
  h *= 0x7feb352du;
  h ^= h >> 15;
  h *= 0x846ca68bu;
  h ^= h >> 16;
  return static_cast<float>(h >> 8) * (2.0f / 16777216.0f) - 1.0f;
}

float fade(float t) { return t * t * t * (t * (t * 6.0f - 15.0f) + 10.0f); }

float lerp(float a, float b, float t) { return a + (b - a) * t; }

float latticePlane(std::int32_t x, std::int32_t y, std::int32_t z, float u, float v,
                   std::uint32_t seed) {
  return lerp(lerp(latticeValue(x, y, z, seed), latticeValue(x + 1, y, z, seed), u),
              lerp(latticeValue(x, y + 1, z, seed), latticeValue(x + 1, y + 1, z, seed), u), v);
}

// std::floor is a library call where the compiler may not assume SSE 4.1.
std::int32_t floorToInt(float x) {
  const auto truncated = static_cast<std::int32_t>(x);
  return truncated - (x < static_cast<float>(truncated) ? 1 : 0);
}

// 1 for a wavelength of 3 pixels and more, 0 from 1 pixel down.
float resolvedShare(float wavelength, float footprint) {
  if (footprint <= 0.0f) return 1.0f;
  return std::min(1.0f, std::max(0.0f, 0.5f * (wavelength / footprint - 1.0f)));
}

template <typename Sample>
float sumOctaves(const FractalNoise& noise, float footprint, Sample sample) {
  float sum = 0.0f;
  float total = 0.0f;
  float amplitude = 1.0f;
  float wavelength = noise.wavelength;
  for (int octave = 0; octave < noise.octaves; ++octave) {
    const float share = resolvedShare(wavelength, footprint);
    if (share > 0.0f) sum += share * amplitude * sample(1.0f / wavelength, noise.seed + octave);
    total += amplitude;
    amplitude *= noise.persistence;
    wavelength *= 0.5f;
  }
  return sum / total;
}

}  // namespace

std::uint64_t hashBits(std::uint64_t seed, std::uint64_t stream, std::uint64_t index) {
  return mix(mix(mix(seed) ^ stream) ^ index);
}

double uniformRandom(std::uint64_t seed, std::uint64_t stream, std::uint64_t index) {
  return static_cast<double>(hashBits(seed, stream, index) >> 11) * 0x1.0p-53;
}

double gaussianRandom(std::uint64_t seed, std::uint64_t stream, std::uint64_t index) {
  const std::uint64_t bits = hashBits(seed, stream, index);
  const double a = (static_cast<double>(bits >> 32) + 1.0) * 0x1.0p-32;  // (0, 1]
  const double b = static_cast<double>(bits & 0xffffffffu) * 0x1.0p-32;
  return std::sqrt(-2.0 * std::log(a)) * std::cos(2.0 * M_PI * b);
}

float valueNoise(float x, float y, std::uint32_t seed) {
  const std::int32_t column = floorToInt(x);
  const std::int32_t row = floorToInt(y);
  return latticePlane(column, row, 0, fade(x - static_cast<float>(column)),
                      fade(y - static_cast<float>(row)), seed);
}

float valueNoise(const Eigen::Vector3f& point, std::uint32_t seed) {
  const std::int32_t x = floorToInt(point.x());
  const std::int32_t y = floorToInt(point.y());
  const std::int32_t z = floorToInt(point.z());
  const float u = fade(point.x() - static_cast<float>(x));
  const float v = fade(point.y() - static_cast<float>(y));
  return lerp(latticePlane(x, y, z, u, v, seed), latticePlane(x, y, z + 1, u, v, seed),
              fade(point.z() - static_cast<float>(z)));
}

float FractalNoise::operator()(float x, float y, float footprint) const {
  return sumOctaves(*this, footprint, [x, y](float frequency, std::uint32_t octave_seed) {
    return valueNoise(x * frequency, y * frequency, octave_seed);
  });
}

float FractalNoise::operator()(const Eigen::Vector3f& point, float footprint) const {
  return sumOctaves(*this, footprint, [&point](float frequency, std::uint32_t octave_seed) {
    return valueNoise(Eigen::Vector3f(point * frequency), octave_seed);
  });
}

}  // namespace simulation
}  // namespace adaptive_grid_stereo
