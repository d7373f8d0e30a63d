#include "adaptive_grid_stereo/simulation/landscape.h"

#include <algorithm>
#include <cmath>

#include "adaptive_grid_stereo/simulation/noise.h"
#include "adaptive_grid_stereo/simulation/terrain.h"

namespace adaptive_grid_stereo {
namespace simulation {
namespace {

// A stream of random numbers for one thing in the landscape.
class Dice {
 public:
  Dice(std::uint64_t seed, std::uint64_t stream) : seed_(seed), stream_(stream) {}
  float uniform(float low, float high) {
    return low + (high - low) * static_cast<float>(uniformRandom(seed_, stream_, index_++));
  }
  std::uint32_t bits() { return static_cast<std::uint32_t>(hashBits(seed_, stream_, index_++)); }

 private:
  std::uint64_t seed_;
  std::uint64_t stream_;
  std::uint64_t index_ = 0;
};

class Planter {
 public:
  Planter(const Trajectory& flight, const LandscapeConfig& config)
      : flight_(flight), config_(config), terrain_(flight, config.seed) {
    foliage_.material = Material::kFoliage;
    needles_.material = Material::kNeedles;
    bark_.material = Material::kBark;
    pole_.material = Material::kPole;
    wall_.material = Material::kWall;
    roof_.material = Material::kRoof;
  }

  void plantAlongPath() {
    for (int i = 0; i < static_cast<int>(flight_.duration() / 0.25); ++i) {
      const FlightSample sample = flight_.at(0.25 * i);
      const Eigen::Vector3f position = sample.position.cast<float>();
      Eigen::Vector3f forward = (sample.attitude * Eigen::Vector3d::UnitX()).cast<float>();
      forward.z() = 0.0f;
      forward.normalize();
      const Eigen::Vector3f left(-forward.y(), forward.x(), 0.0f);
      Dice dice(config_.seed, 1000 + i);
      for (const float side : {-1.0f, 1.0f}) {
        for (const float reach : {14.0f, 28.0f, 60.0f}) {
          const Eigen::Vector3f place = position + dice.uniform(-4.0f, 30.0f) * forward +
                                        side * dice.uniform(0.3f * reach, reach) * left;
          plantSomething(place.x(), place.y(), &dice);
        }
      }
    }
  }

  void plantAround() {
    const Eigen::Vector2f low = terrain_.lowerCorner().array() - 160.0f;
    const Eigen::Vector2f high = terrain_.upperCorner().array() + 160.0f;
    const Eigen::Vector2f size = high - low;
    const int count = std::min(1500, static_cast<int>(size.x() * size.y() / 170.0f));
    for (int i = 0; i < count; ++i) {
      Dice dice(config_.seed, 200000 + i);
      plantSomething(dice.uniform(low.x(), high.x()), dice.uniform(low.y(), high.y()), &dice);
    }
  }

  std::vector<Mesh> meshes() {
    foliage_.computeNormals();
    return {terrain_.mesh(), foliage_, needles_, bark_, pole_, wall_, roof_};
  }

 private:
  // True if something of this radius and height [m] keeps clear of the aircraft.
  bool isFree(float x, float y, float radius, float height) const {
    const float needed = radius + config_.clearance;
    float aircraft = 0.0f;
    if (terrain_.distanceFromPath(x, y, needed, &aircraft) >= needed) return true;
    // Near the track only what the aircraft passes over with room to spare at every point.
    for (double time = 0.0; time <= flight_.duration(); time += 0.1) {
      const Eigen::Vector3f point = flight_.at(time).position.cast<float>();
      const float dx = point.x() - x;
      const float dy = point.y() - y;
      if (dx * dx + dy * dy < needed * needed &&
          terrain_.height(x, y) + height + config_.clearance > point.z()) {
        return false;
      }
    }
    return true;
  }

  void plantSomething(float x, float y, Dice* dice) {
    const float kind = dice->uniform(0.0f, 1.0f);
    if (kind < 0.26f) {
      conifer(x, y, dice);
    } else if (kind < 0.50f) {
      broadleaf(x, y, dice);
    } else if (kind < 0.72f) {
      bush(x, y, dice);
    } else if (kind < 0.93f) {
      pole(x, y, dice);
    } else {
      house(x, y, dice);
    }
  }

  void conifer(float x, float y, Dice* dice) {
    const float height = dice->uniform(7.0f, 15.0f);
    const float radius = 0.20f * height;
    if (!isFree(x, y, radius, height)) return;
    const Eigen::Vector3f foot(x, y, terrain_.height(x, y));
    const auto up = [&foot](float z) { return Eigen::Vector3f(foot + Eigen::Vector3f(0, 0, z)); };
    addTube(up(-0.5f), up(0.5f * height), 0.018f * height, 0.012f * height, 8, &bark_);
    constexpr int kLayers = 6;
    for (int i = 0; i < kLayers; ++i) {
      const float from = 0.12f + 0.80f * static_cast<float>(i) / kLayers;
      const float width = radius * (1.0f - from) * dice->uniform(0.95f, 1.25f);
      const Eigen::Vector3f lean(dice->uniform(-0.1f, 0.1f), dice->uniform(-0.1f, 0.1f), 0.0f);
      addTube(up(from * height) + lean, up(std::min(1.0f, from + 0.27f) * height), width, 0.02f, 11,
              &needles_);
    }
  }

  void broadleaf(float x, float y, Dice* dice) {
    const float height = dice->uniform(5.0f, 11.0f);
    const float radius = 0.32f * height;
    if (!isFree(x, y, radius, height)) return;
    const Eigen::Vector3f foot(x, y, terrain_.height(x, y) - 0.5f);
    const Eigen::Vector3f fork = foot + Eigen::Vector3f(0, 0, 0.5f * height);
    addTube(foot, fork, 0.028f * height, 0.02f * height, 9, &bark_);
    for (int i = 0; i < 6; ++i) {
      const float angle = dice->uniform(0.0f, 2.0f * static_cast<float>(M_PI));
      const float reach = dice->uniform(0.1f, 0.55f) * radius;
      const Eigen::Vector3f center =
          foot + Eigen::Vector3f(reach * std::cos(angle), reach * std::sin(angle),
                                 height * dice->uniform(0.5f, 0.82f));
      const float size = radius * dice->uniform(0.45f, 0.65f);
      addTube(fork, center, 0.012f * height, 0.004f * height, 6, &bark_);
      addBlob(center, {size, size, 0.85f * size}, 0.35f, dice->bits(), &foliage_);
    }
  }

  void bush(float x, float y, Dice* dice) {
    const float size = dice->uniform(0.4f, 1.4f);
    if (!isFree(x, y, size, size)) return;
    const Eigen::Vector3f foot(x, y, terrain_.height(x, y));
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3f offset(dice->uniform(-size, size), dice->uniform(-size, size),
                                   0.3f * size);
      addBlob(foot + 0.7f * offset, {size, size, 0.9f * size}, 0.4f, dice->bits(), &foliage_);
    }
  }

  void pole(float x, float y, Dice* dice) {
    const float height = dice->uniform(7.0f, 11.0f);
    if (!isFree(x, y, 1.0f, height)) return;
    const Eigen::Vector3f foot(x, y, terrain_.height(x, y) - 0.5f);
    const Eigen::Vector3f top = foot + Eigen::Vector3f(0, 0, height);
    addTube(foot, top, 0.17f, 0.13f, 12, &pole_);
    const float angle = dice->uniform(0.0f, static_cast<float>(M_PI));
    const Eigen::Vector3f arm(0.9f * std::cos(angle), 0.9f * std::sin(angle), 0.0f);
    const Eigen::Vector3f joint = top - Eigen::Vector3f(0, 0, 0.6f);
    addTube(joint - arm, joint + arm, 0.08f, 0.08f, 8, &pole_);
  }

  void house(float x, float y, Dice* dice) {
    const float length = dice->uniform(4.0f, 6.0f);  // half sizes
    const float width = dice->uniform(3.0f, 4.0f);
    const float eaves = dice->uniform(3.0f, 5.0f);
    const float ridge = eaves + 0.75f * width;
    if (!isFree(x, y, length + 1.0f, ridge)) return;
    const float angle = dice->uniform(0.0f, static_cast<float>(M_PI));
    const Eigen::Vector3f along(std::cos(angle), std::sin(angle), 0.0f);
    const Eigen::Vector3f across(-along.y(), along.x(), 0.0f);
    float ground = terrain_.height(x, y);
    for (const float a : {-length, length}) {
      for (const float b : {-width, width}) {
        const Eigen::Vector3f corner = a * along + b * across;
        ground = std::max(ground, terrain_.height(x + corner.x(), y + corner.y()));
      }
    }
    const auto at = [&](float a, float b, float z) {
      return Eigen::Vector3f(Eigen::Vector3f(x, y, ground + z) + a * along + b * across);
    };
    constexpr float kCellar = -4.0f;  // down into the slope
    for (const float side : {-1.0f, 1.0f}) {
      const float w = side * width;
      const float l = side * length;
      addQuad(at(-length, w, kCellar), at(length, w, kCellar), at(length, w, eaves),
              at(-length, w, eaves), &wall_);
      addQuad(at(l, -width, kCellar), at(l, width, kCellar), at(l, width, eaves),
              at(l, -width, eaves), &wall_);
      const auto first = static_cast<std::uint32_t>(wall_.vertices.size());
      wall_.vertices.insert(wall_.vertices.end(),
                            {at(l, -width, eaves), at(l, width, eaves), at(l, 0.0f, ridge)});
      wall_.triangles.push_back({first, first + 1, first + 2});
      // The roof overhangs the walls.
      const float drop = eaves - 0.12f * (ridge - eaves);
      addQuad(at(-length - 0.5f, 1.12f * w, drop + 0.1f), at(length + 0.5f, 1.12f * w, drop + 0.1f),
              at(length + 0.5f, 0.0f, ridge + 0.1f), at(-length - 0.5f, 0.0f, ridge + 0.1f),
              &roof_);
    }
  }

  const Trajectory& flight_;
  LandscapeConfig config_;
  Terrain terrain_;
  Mesh foliage_, needles_, bark_, pole_, wall_, roof_;
};

}  // namespace

std::vector<Mesh> makeLandscape(const Trajectory& flight, const LandscapeConfig& config) {
  Planter planter(flight, config);
  planter.plantAlongPath();
  planter.plantAround();
  return planter.meshes();
}

}  // namespace simulation
}  // namespace adaptive_grid_stereo
