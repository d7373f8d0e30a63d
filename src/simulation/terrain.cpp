#include "adaptive_grid_stereo/simulation/terrain.h"

#include <algorithm>
#include <cmath>

#include "adaptive_grid_stereo/simulation/flight_plan.h"
#include "adaptive_grid_stereo/simulation/noise.h"

namespace adaptive_grid_stereo {
namespace simulation {
namespace {

constexpr float kValley = -5.5f;         // mean height of the ground below the flight [m]
constexpr float kHorizon = 1600.0f;      // how far the ground reaches beyond the flight [m]
constexpr float kFineMargin = 70.0f;     // fine triangles so far around the path [m]
constexpr float kCarveDistance = 30.0f;  // relief gives way to the aircraft so far around it [m]

float smoothStep(float low, float high, float x) {
  const float t = std::min(1.0f, std::max(0.0f, (x - low) / (high - low)));
  return t * t * (3.0f - 2.0f * t);
}

// Coordinates of grid lines: `spacing` between low and high, growing by 5 % a line beyond.
std::vector<float> gridLines(float low, float high, float spacing) {
  std::vector<float> outside;
  float step = spacing;
  for (float distance = step; distance < kHorizon; distance += step) {
    outside.push_back(distance);
    step *= 1.05f;
  }
  std::vector<float> lines;
  for (auto it = outside.rbegin(); it != outside.rend(); ++it) lines.push_back(low - *it);
  const int count = static_cast<int>(std::ceil((high - low) / spacing));
  for (int i = 0; i <= count; ++i)
    lines.push_back(low + (high - low) * static_cast<float>(i) / count);
  for (const float distance : outside) lines.push_back(high + distance);
  return lines;
}

}  // namespace

Terrain::Terrain(const Trajectory& flight, std::uint64_t seed)
    : seed_(static_cast<std::uint32_t>(hashBits(seed, 11, 0))),
      has_runway_(flight.at(0.0).position.z() < 0.5 * (kStandingHeight + kCruiseHeight)) {
  lower_.setConstant(1e9f);
  upper_.setConstant(-1e9f);
  for (double time = 0.0; time <= flight.duration(); time += 0.1) {
    path_.push_back(flight.at(time).position.cast<float>());
    lower_ = lower_.cwiseMin(path_.back().head<2>());
    upper_ = upper_.cwiseMax(path_.back().head<2>());
  }
}

float Terrain::runwayShare(float x, float y) const {
  if (!has_runway_) return 0.0f;
  const float dx = std::max(std::max(-12.0f - x, x - 32.0f), 0.0f);
  return 1.0f - smoothStep(5.0f, 30.0f, std::hypot(dx, y));
}

float Terrain::distanceFromPath(float x, float y, float limit, float* aircraft_height) const {
  float nearest = limit * limit;
  for (const Eigen::Vector3f& point : path_) {
    const float dx = point.x() - x;
    const float dy = point.y() - y;
    const float squared = dx * dx + dy * dy;
    if (squared < nearest) {
      nearest = squared;
      *aircraft_height = point.z();
    }
  }
  return std::sqrt(nearest);
}

float Terrain::height(float x, float y) const {
  FractalNoise relief;
  relief.seed = seed_;
  relief.wavelength = 55.0f;
  relief.octaves = 5;
  relief.persistence = 0.45f;
  FractalNoise hills;
  hills.seed = seed_ + 100;
  hills.wavelength = 420.0f;
  hills.octaves = 6;
  hills.persistence = 0.42f;
  const float outside =
      std::max({lower_.x() - x, x - upper_.x(), lower_.y() - y, y - upper_.y(), 0.0f});
  const float rise = smoothStep(40.0f, 700.0f, outside);

  float height =
      kValley + 5.0f * relief(x, y, 0.0f) + rise * (45.0f + 75.0f * (hills(x, y, 0.0f) + 0.35f));
  const float runway = runwayShare(x, y);
  height = (1.0f - runway) * height;  // the runway lies at height 0

  // Below every point of the path a bowl: nothing of the ground reaches into it.
  if (outside < kCarveDistance) {
    for (const Eigen::Vector3f& point : path_) {
      const float dx = point.x() - x;
      const float dy = point.y() - y;
      const float squared = dx * dx + dy * dy;
      if (squared > kCarveDistance * kCarveDistance) continue;
      const float from_start = (point.head<2>() - path_.front().head<2>()).norm();
      const float below = static_cast<float>(kStandingHeight) + std::min(1.5f, 0.04f * from_start);
      height = std::min(height, point.z() - below + 0.02f * squared);
    }
  }
  return height;
}

Mesh Terrain::mesh() const {
  const Eigen::Vector2f low = lower_.array() - kFineMargin;
  const Eigen::Vector2f high = upper_.array() + kFineMargin;
  const float spacing = std::max(1.0f, (high - low).maxCoeff() / 600.0f);
  const std::vector<float> xs = gridLines(low.x(), high.x(), spacing);
  const std::vector<float> ys = gridLines(low.y(), high.y(), spacing);

  Mesh mesh;
  mesh.material = Material::kGround;
  mesh.vertices.reserve(xs.size() * ys.size());
  for (const float y : ys) {
    for (const float x : xs) mesh.vertices.emplace_back(x, y, height(x, y));
  }
  const auto columns = static_cast<std::uint32_t>(xs.size());
  for (std::uint32_t row = 0; row + 1 < ys.size(); ++row) {
    for (std::uint32_t column = 0; column + 1 < columns; ++column) {
      const std::uint32_t corner = row * columns + column;
      mesh.triangles.push_back({corner, corner + 1, corner + columns + 1});
      mesh.triangles.push_back({corner, corner + columns + 1, corner + columns});
    }
  }
  mesh.computeNormals();
  return mesh;
}

}  // namespace simulation
}  // namespace adaptive_grid_stereo
