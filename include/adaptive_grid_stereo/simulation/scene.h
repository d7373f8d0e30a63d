#ifndef ADAPTIVE_GRID_STEREO_SIMULATION_SCENE_H
#define ADAPTIVE_GRID_STEREO_SIMULATION_SCENE_H

#include <array>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "adaptive_grid_stereo/simulation/mesh.h"

namespace adaptive_grid_stereo {
namespace simulation {

/// Where a ray meets a surface.
struct SurfacePoint {
  float distance = 0.0f;  // in lengths of the ray's direction
  Eigen::Vector3f position = Eigen::Vector3f::Zero();
  Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();  // unit, on the ray's side
  Material material = Material::kGround;
};

/// Up to 8 rays that run close together, as those of one pixel do; Embree takes them in one go.
struct RayBundle {
  static constexpr int kSize = 8;
  int count = 0;
  std::array<Eigen::Vector3f, kSize> origins;
  std::array<Eigen::Vector3f, kSize> directions;

  void add(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction) {
    origins[count] = origin;
    directions[count++] = direction;
  }
};

/// Meshes that answer rays (Embree). Queries are thread safe.
class Scene {
 public:
  /// Throws std::runtime_error if Embree cannot build the scene.
  explicit Scene(std::vector<Mesh> meshes);
  ~Scene();

  /// The nearest surface along the ray; false if it reaches the sky.
  bool intersect(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction,
                 SurfacePoint* point) const;

  /// The nearest surface along each ray of the bundle; hits[i] is false if ray i reaches the sky.
  void intersect(const RayBundle& rays, std::array<SurfacePoint, RayBundle::kSize>* points,
                 std::array<bool, RayBundle::kSize>* hits) const;

  /// Whether anything lies within `far` along each ray of the bundle.
  void occluded(const RayBundle& rays, float far, std::array<bool, RayBundle::kSize>* hits) const;

  /// True if anything lies between origin + near * direction and origin + far * direction.
  bool occluded(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float near,
                float far) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace simulation
}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SIMULATION_SCENE_H
