#ifndef ADAPTIVE_GRID_STEREO_SIMULATION_MESH_H
#define ADAPTIVE_GRID_STEREO_SIMULATION_MESH_H

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace adaptive_grid_stereo {
namespace simulation {

enum class Material { kGround, kFoliage, kNeedles, kBark, kPole, kWall, kRoof };

/// Triangles of one material in the world frame (ENU) [m].
struct Mesh {
  Material material = Material::kGround;
  std::vector<Eigen::Vector3f> vertices;
  /// Empty (flat shading), or one unit normal per vertex (smooth shading).
  std::vector<Eigen::Vector3f> normals;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  /// Sets the normals to the area-weighted mean of the adjacent triangles'.
  void computeNormals();
};

/// A tube around the line from `bottom` to `top` with the given radii [m]; a radius of 0 makes a
/// cone. Appends to `mesh`, which must be one without normals.
void addTube(const Eigen::Vector3f& bottom, const Eigen::Vector3f& top, float bottom_radius,
             float top_radius, int sides, Mesh* mesh);

/// A lumpy ball: an ellipsoid whose surface is moved in and out by noise of relative size
/// `roughness`. Appends to `mesh`, which must be one without normals.
void addBlob(const Eigen::Vector3f& center, const Eigen::Vector3f& radii, float roughness,
             std::uint32_t seed, Mesh* mesh);

/// A rectangle with corners a, b, c, d in turn.
void addQuad(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c,
             const Eigen::Vector3f& d, Mesh* mesh);

}  // namespace simulation
}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SIMULATION_MESH_H
