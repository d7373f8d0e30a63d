#include "adaptive_grid_stereo/simulation/mesh.h"

#include <cmath>
#include <map>
#include <utility>

#include <Eigen/Geometry>

#include "adaptive_grid_stereo/simulation/noise.h"

namespace adaptive_grid_stereo {
namespace simulation {
namespace {

// The unit sphere as an icosahedron whose triangles are split in four, twice.
Mesh makeSphere() {
  const float t = 0.5f * (1.0f + std::sqrt(5.0f));
  Mesh sphere;
  for (const float a : {-1.0f, 1.0f}) {
    for (const float b : {-t, t}) {
      sphere.vertices.push_back(Eigen::Vector3f(a, b, 0.0f).normalized());
      sphere.vertices.push_back(Eigen::Vector3f(0.0f, a, b).normalized());
      sphere.vertices.push_back(Eigen::Vector3f(b, 0.0f, a).normalized());
    }
  }
  // Faces of the icosahedron: all triples of vertices that are neighbours.
  const float edge = 1.1f * 4.0f / (1.0f + t * t);
  const auto near = [&](std::uint32_t i, std::uint32_t j) {
    return (sphere.vertices[i] - sphere.vertices[j]).squaredNorm() < edge;
  };
  for (std::uint32_t i = 0; i < 12; ++i) {
    for (std::uint32_t j = i + 1; j < 12; ++j) {
      for (std::uint32_t k = j + 1; k < 12; ++k) {
        if (near(i, j) && near(j, k) && near(i, k)) sphere.triangles.push_back({i, j, k});
      }
    }
  }
  for (int level = 0; level < 2; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t i, std::uint32_t j) {
      const auto added = middles.emplace(std::minmax(i, j), sphere.vertices.size());
      if (added.second) {
        const Eigen::Vector3f point = (sphere.vertices[i] + sphere.vertices[j]).normalized();
        sphere.vertices.push_back(point);
      }
      return added.first->second;
    };
    std::vector<std::array<std::uint32_t, 3>> split;
    for (const auto& face : sphere.triangles) {
      const std::uint32_t ab = middle(face[0], face[1]);
      const std::uint32_t bc = middle(face[1], face[2]);
      const std::uint32_t ca = middle(face[2], face[0]);
      split.push_back({face[0], ab, ca});
      split.push_back({face[1], bc, ab});
      split.push_back({face[2], ca, bc});
      split.push_back({ab, bc, ca});
    }
    sphere.triangles = std::move(split);
  }
  return sphere;
}

}  // namespace

void Mesh::computeNormals() {
  normals.assign(vertices.size(), Eigen::Vector3f::Zero());
  for (const auto& triangle : triangles) {
    const Eigen::Vector3f& a = vertices[triangle[0]];
    const Eigen::Vector3f cross = (vertices[triangle[1]] - a).cross(vertices[triangle[2]] - a);
    for (const std::uint32_t corner : triangle) normals[corner] += cross;
  }
  for (Eigen::Vector3f& normal : normals) normal.normalize();
}

void addTube(const Eigen::Vector3f& bottom, const Eigen::Vector3f& top, float bottom_radius,
             float top_radius, int sides, Mesh* mesh) {
  const Eigen::Vector3f axis = (top - bottom).normalized();
  const Eigen::Vector3f u = axis.unitOrthogonal();
  const Eigen::Vector3f v = axis.cross(u);
  const auto first = static_cast<std::uint32_t>(mesh->vertices.size());
  for (int i = 0; i < sides; ++i) {
    const float angle = 2.0f * static_cast<float>(M_PI) * static_cast<float>(i) / sides;
    const Eigen::Vector3f spoke = std::cos(angle) * u + std::sin(angle) * v;
    mesh->vertices.push_back(bottom + bottom_radius * spoke);
    mesh->vertices.push_back(top + top_radius * spoke);
  }
  const auto count = static_cast<std::uint32_t>(2 * sides);
  for (std::uint32_t i = 0; i < count; i += 2) {
    const std::uint32_t next = (i + 2) % count;
    mesh->triangles.push_back({first + i, first + next, first + i + 1});
    mesh->triangles.push_back({first + next, first + next + 1, first + i + 1});
  }
}

void addBlob(const Eigen::Vector3f& center, const Eigen::Vector3f& radii, float roughness,
             std::uint32_t seed, Mesh* mesh) {
  static const Mesh sphere = makeSphere();
  const auto first = static_cast<std::uint32_t>(mesh->vertices.size());
  FractalNoise lumps;
  lumps.seed = seed;
  lumps.wavelength = 0.8f;
  lumps.octaves = 2;
  lumps.persistence = 0.6f;
  for (const Eigen::Vector3f& point : sphere.vertices) {
    const float swell = 1.0f + roughness * lumps(point, 0.0f);
    mesh->vertices.push_back(center + swell * radii.cwiseProduct(point));
  }
  for (const auto& face : sphere.triangles) {
    mesh->triangles.push_back({first + face[0], first + face[1], first + face[2]});
  }
}

void addQuad(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c,
             const Eigen::Vector3f& d, Mesh* mesh) {
  const auto first = static_cast<std::uint32_t>(mesh->vertices.size());
  mesh->vertices.insert(mesh->vertices.end(), {a, b, c, d});
  mesh->triangles.push_back({first, first + 1, first + 2});
  mesh->triangles.push_back({first, first + 2, first + 3});
}

}  // namespace simulation
}  // namespace adaptive_grid_stereo
