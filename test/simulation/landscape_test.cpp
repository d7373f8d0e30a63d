#include "adaptive_grid_stereo/simulation/landscape.h"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "adaptive_grid_stereo/simulation/flight_plan.h"
#include "adaptive_grid_stereo/simulation/renderer.h"

namespace adaptive_grid_stereo {
namespace simulation {
namespace {

class LandscapeTest : public ::testing::TestWithParam<int> {
 protected:
  LandscapeConfig config() const {
    LandscapeConfig config;
    config.seed = static_cast<std::uint64_t>(GetParam());
    return config;
  }
  const Trajectory flight_ = makeFlight(manoeuvresFromString("all"), 30.0);
};

TEST_P(LandscapeTest, NothingStandsInTheWayOfTheAircraft) {
  const std::vector<Mesh> meshes = makeLandscape(flight_, config());
  std::vector<Eigen::Vector3f> path;
  for (double time = 0.0; time <= 30.0; time += 0.2) {
    path.push_back(flight_.at(time).position.cast<float>());
  }
  for (const Mesh& mesh : meshes) {
    float nearest = 1e9f;
    for (const Eigen::Vector3f& vertex : mesh.vertices) {
      for (const Eigen::Vector3f& point : path) {
        nearest = std::min(nearest, (vertex - point).squaredNorm());
      }
    }
    // The ground comes as near as the height of the camera on the runway.
    EXPECT_GT(std::sqrt(nearest), 1.7f) << "material " << static_cast<int>(mesh.material);
  }
}

TEST_P(LandscapeTest, GroundReachesTheHorizonWithoutAGap) {
  const Scene scene(makeLandscape(flight_, config()));
  for (double time = 0.0; time < 30.0; time += 1.0) {
    const Eigen::Vector3f eye = flight_.at(time).position.cast<float>();
    for (int i = 0; i < 64; ++i) {
      const float angle = 2.0f * static_cast<float>(M_PI) * static_cast<float>(i) / 64.0f;
      for (const float down : {-0.03f, -0.2f, -1.0f, -20.0f}) {
        SurfacePoint point;
        ASSERT_TRUE(scene.intersect(eye, {std::cos(angle), std::sin(angle), down}, &point))
            << "at " << time << " s, direction " << angle << " rad, slope " << down;
      }
    }
  }
}

TEST_P(LandscapeTest, HasEveryKindOfThing) {
  std::set<Material> materials;
  for (const Mesh& mesh : makeLandscape(flight_, config())) {
    if (!mesh.triangles.empty()) materials.insert(mesh.material);
  }
  EXPECT_EQ(materials.size(), 7u);
}

TEST_P(LandscapeTest, DisparitiesFitTheDefaultRange) {
  const Scene scene(makeLandscape(flight_, config()));
  RendererConfig renderer;
  renderer.samples = 1;
  renderer.rig.width = 128;
  renderer.rig.height = 72;
  renderer.rig.focal = 100.0;
  renderer.rig.baseline = 1.6;  // the same disparities as the default rig's
  float largest = 0.0f;
  for (double time = 0.0; time < 30.0; time += 0.5) {
    const StereoFrame frame = Renderer(scene, renderer).render(flight_, time, 0);
    double maximum = 0.0;
    cv::minMaxLoc(frame.disparity, nullptr, &maximum);
    EXPECT_LT(maximum, 63.0) << "at " << time << " s";
    largest = std::max(largest, static_cast<float>(maximum));
  }
  EXPECT_GT(largest, 20.0f) << "something comes near";
}

INSTANTIATE_TEST_SUITE_P(Seeds, LandscapeTest, ::testing::Values(1, 2));

TEST(Landscape, SameSeedSameLandscape) {
  const Trajectory flight = makeFlight(manoeuvresFromString("forward"), 3.0);
  const auto vertices = [&flight](std::uint64_t seed) {
    LandscapeConfig config;
    config.seed = seed;
    std::vector<Eigen::Vector3f> all;
    for (const Mesh& mesh : makeLandscape(flight, config)) {
      all.insert(all.end(), mesh.vertices.begin(), mesh.vertices.end());
    }
    return all;
  };
  EXPECT_TRUE(vertices(1) == vertices(1));
  EXPECT_FALSE(vertices(1) == vertices(2));
}

}  // namespace
}  // namespace simulation
}  // namespace adaptive_grid_stereo
