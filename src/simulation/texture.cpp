#include "adaptive_grid_stereo/simulation/texture.h"

#include <algorithm>
#include <cmath>

#include "adaptive_grid_stereo/simulation/noise.h"

namespace adaptive_grid_stereo {
namespace simulation {
namespace {

float clamp01(float x) { return std::min(1.0f, std::max(0.0f, x)); }

float smoothStep(float low, float high, float x) {
  const float t = clamp01((x - low) / (high - low));
  return t * t * (3.0f - 2.0f * t);
}

// 1 inside a stripe of `width`, 0 outside, repeating every `period`; edges as soft as a pixel.
float stripes(float x, float period, float width, float footprint) {
  if (footprint > 0.5f * period) return width / period;
  const float phase = x - period * std::floor(x / period);
  const float soft = std::max(0.5f * footprint, 1e-3f);
  const float center = std::abs(phase - 0.5f * width);
  return clamp01(0.5f + (0.5f * width - center) / (2.0f * soft));
}

float ground(const Eigen::Vector3f& p, float footprint) {
  const FractalNoise patches{21, 28.0f, 3, 0.6f};
  const FractalNoise tufts{31, 3.2f, 7, 1.0f};
  const FractalNoise winding{61, 40.0f, 2, 0.5f};
  const float patch = patches(p.x(), p.y(), footprint);
  float value = 0.36f + 0.13f * patch + 0.90f * tufts(p.x(), p.y(), footprint);
  // Ploughed fields where the patches are dark: furrows.
  const float field = smoothStep(-0.15f, -0.25f, patch);
  if (field > 0.0f) {
    const float furrow = stripes(p.x() + 0.6f * p.y(), 1.4f, 0.5f, footprint);
    value += field * (0.10f * furrow - 0.04f);
  }
  // Tracks: bright gravel along a few winding lines.
  const float offset = 9.0f * winding(p.x(), p.y(), 0.0f);
  const float across = p.y() + offset - 60.0f * std::floor((p.y() + offset) / 60.0f) - 30.0f;
  const float track = smoothStep(2.4f, 1.7f, std::abs(across));
  return value + track * (0.20f - 0.1f * patch);
}

float foliage(const Eigen::Vector3f& p, float footprint, float mean) {
  const FractalNoise leaves{41, 1.0f, 5, 1.1f};
  const FractalNoise clumps{47, 3.5f, 2, 0.6f};
  return mean + 0.95f * leaves(p, footprint) + 0.08f * clumps(p, footprint);
}

float bark(const Eigen::Vector3f& p, float footprint) {
  const FractalNoise streaks{51, 0.25f, 3, 0.7f};
  return 0.26f + 0.3f * streaks(Eigen::Vector3f(p.x(), p.y(), 0.15f * p.z()), footprint);
}

float pole(const Eigen::Vector3f& p, float footprint) {
  const FractalNoise grain{71, 0.5f, 4, 0.75f};
  const float band = stripes(p.z(), 2.0f, 0.5f, footprint);
  return 0.45f + 0.22f * grain(Eigen::Vector3f(3.0f * p.x(), 3.0f * p.y(), p.z()), footprint) +
         0.22f * band;
}

float wall(const Eigen::Vector3f& p, const Eigen::Vector3f& n, float footprint) {
  // Along the wall: the horizontal direction across its normal.
  const float along = -n.y() * p.x() + n.x() * p.y();
  const FractalNoise plaster{81, 1.6f, 6, 0.8f};
  const float joints =
      std::max(stripes(p.z(), 0.45f, 0.05f, footprint),
               stripes(along + 0.3f * std::floor(p.z() / 0.45f), 0.6f, 0.05f, footprint));
  const float window =
      stripes(along, 2.6f, 1.1f, footprint) * stripes(p.z() - 0.9f, 2.6f, 1.3f, footprint);
  const float value = 0.62f + 0.3f * plaster(along, p.z(), footprint) - 0.18f * joints;
  return value + window * (0.12f - value);
}

float roof(const Eigen::Vector3f& p, const Eigen::Vector3f& n, float footprint) {
  const float along = -n.y() * p.x() + n.x() * p.y();
  const FractalNoise weathering{91, 1.1f, 6, 0.8f};
  const float rows = stripes(p.z(), 0.28f, 0.07f, footprint);
  const float tiles = stripes(along, 0.4f, 0.06f, footprint);
  return 0.36f + 0.3f * weathering(along, p.z(), footprint) - 0.14f * std::max(rows, tiles);
}

}  // namespace

float albedo(Material material, const Eigen::Vector3f& position, const Eigen::Vector3f& normal,
             float footprint) {
  switch (material) {
    case Material::kGround:
      return clamp01(ground(position, footprint));
    case Material::kFoliage:
      return clamp01(foliage(position, footprint, 0.34f));
    case Material::kNeedles:
      return clamp01(foliage(position, footprint, 0.28f));
    case Material::kBark:
      return clamp01(bark(position, footprint));
    case Material::kPole:
      return clamp01(pole(position, footprint));
    case Material::kWall:
      return clamp01(wall(position, normal, footprint));
    case Material::kRoof:
      return clamp01(roof(position, normal, footprint));
  }
  return 0.0f;
}

float skyBrightness(const Eigen::Vector3f& direction, float angle) {
  const float elevation = std::max(direction.z(), 0.0f);
  const float clear = kHazeBrightness - 0.26f * std::sqrt(elevation);
  // Clouds hang on a plane; towards the horizon they shrink and fade into the haze.
  const float slant = 1.0f / (elevation + 0.06f);
  const FractalNoise clouds{111, 1.6f, 6, 0.55f};
  const float cover = clouds(direction.x() * slant, direction.y() * slant, angle * slant * slant);
  const float amount = smoothStep(-0.05f, 0.55f, cover) * smoothStep(0.0f, 0.18f, elevation);
  return clear + amount * (0.97f - clear);
}

}  // namespace simulation
}  // namespace adaptive_grid_stereo
