#include "adaptive_grid_stereo/simulation/renderer.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace adaptive_grid_stereo {
namespace simulation {
namespace {

// A camera that stands still at height 10 m and looks east; the cameras sit in the body's origin.
Trajectory standing() {
  return Trajectory(SmoothProfile(0.0), SmoothProfile(), SmoothProfile(), {0, 0, 10}, 1.0);
}

RendererConfig smallConfig() {
  RendererConfig config;
  config.rig.width = 96;
  config.rig.height = 54;
  config.rig.focal = 75.0;
  config.rig.baseline = 0.8;
  config.rig.mount_forward = 0.0;
  return config;
}

// A wall across the view, `distance` [m] ahead, between the given heights and northings.
Mesh wallAt(float distance, float south, float north, float low, float high) {
  Mesh mesh;
  mesh.material = Material::kFoliage;
  addQuad({distance, south, low}, {distance, north, low}, {distance, north, high},
          {distance, south, high}, &mesh);
  return mesh;
}

bool equal(const cv::Mat& a, const cv::Mat& b) { return cv::countNonZero(a != b) == 0; }

TEST(Renderer, WallAcrossTheViewHasOneDisparity) {
  const RendererConfig config = smallConfig();
  const Scene scene({wallAt(20.0f, -100, 100, -100, 100)});
  const StereoFrame frame = Renderer(scene, config).render(standing(), 0.0, 0);
  const float expected = 75.0f * 0.8f / 20.0f;
  for (int row = 0; row < 54; ++row) {
    for (int column = 0; column < 96; ++column) {
      ASSERT_NEAR(frame.disparity.at<float>(row, column), expected, 1e-4f);
      // The first columns have no partner: x - d < 0 (by half a pixel's grace).
      ASSERT_EQ(frame.occlusion.at<unsigned char>(row, column),
                column - expected < -0.5f ? kOutOfView : kVisible);
    }
  }
}

TEST(Renderer, LevelGroundHasDisparityLinearInTheRow) {
  const RendererConfig config = smallConfig();
  Mesh ground;
  addQuad({-1000, -1000, 0}, {1000, -1000, 0}, {1000, 1000, 0}, {-1000, 1000, 0}, &ground);
  const StereoFrame frame = Renderer(Scene({ground}), config).render(standing(), 0.0, 0);
  for (int row = 0; row < 54; ++row) {
    const double below = row - config.rig.cy();
    const double depth = below > 0 ? 75.0 * 10.0 / below : INFINITY;  // f h / (v - cy)
    for (int column = 0; column < 96; column += 5) {
      const double expected = depth < 900.0 ? 75.0 * 0.8 / depth : 0.0;
      if (depth > 900.0 && depth < 1200.0) continue;  // where the ground ends
      ASSERT_NEAR(frame.disparity.at<float>(row, column), expected, 1e-4) << "row " << row;
    }
  }
}

TEST(Renderer, SkyHasDisparityZeroAndIsVisible) {
  const Scene scene({wallAt(20.0f, -100, 100, -200, -100)});
  const StereoFrame frame = Renderer(scene, smallConfig()).render(standing(), 0.0, 0);
  EXPECT_EQ(cv::countNonZero(frame.disparity), 0);
  EXPECT_EQ(cv::countNonZero(frame.occlusion), 0);
}

TEST(Renderer, AnObjectHidesAStripAtItsLeftAsWideAsTheStepInDisparity) {
  const RendererConfig config = smallConfig();
  // 5 m and 30 m: disparities 12 and 2.
  const Scene scene({wallAt(5.0f, -1.0f, 1.0f, 9.0f, 11.0f), wallAt(30.0f, -100, 100, -100, 100)});
  const StereoFrame frame = Renderer(scene, config).render(standing(), 0.0, 0);
  const int row = 27;
  int first_near = -1;
  int hidden = 0;
  for (int column = 0; column < 96; ++column) {
    const float disparity = frame.disparity.at<float>(row, column);
    if (first_near < 0 && disparity > 7.0f) first_near = column;
    if (frame.occlusion.at<unsigned char>(row, column) == kOccluded) {
      ++hidden;
      EXPECT_LT(disparity, 7.0f) << "the background is hidden, not the object";
      EXPECT_TRUE(first_near < 0) << "at its left side, as the left camera sees it";
    }
  }
  ASSERT_GT(first_near, 0);
  EXPECT_NEAR(hidden, 10, 1);
  EXPECT_EQ(frame.occlusion.at<unsigned char>(row, first_near - 1), kOccluded);
}

TEST(Renderer, RightImageShiftedByTheTruthIsTheLeftImage) {
  RendererConfig config = smallConfig();
  config.noise = 0.0;
  config.samples = 64;
  const Scene scene({wallAt(20.0f, -100, 100, -100, 100)});  // 3 pixels exactly
  const StereoFrame frame = Renderer(scene, config).render(standing(), 0.0, 0);
  const cv::Mat left = frame.left.colRange(3, 96);
  const cv::Mat right = frame.right.colRange(0, 93);
  cv::Mat difference;
  cv::absdiff(left, right, difference);
  EXPECT_LT(cv::mean(difference)[0], 1.5);
  cv::Scalar mean, deviation;
  cv::meanStdDev(frame.left, mean, deviation);
  EXPECT_GT(deviation[0], 5.0) << "there is texture to match";
}

TEST(Renderer, ResultDependsOnSeedAndFrameAlone) {
  RendererConfig config = smallConfig();
  const Scene scene({wallAt(20.0f, -100, 100, -100, 10.5)});
  config.threads = 1;
  const StereoFrame one = Renderer(scene, config).render(standing(), 0.0, 5);
  config.threads = 3;
  const StereoFrame three = Renderer(scene, config).render(standing(), 0.0, 5);
  EXPECT_TRUE(equal(one.left, three.left));
  EXPECT_TRUE(equal(one.right, three.right));
  EXPECT_TRUE(equal(one.disparity, three.disparity));
  EXPECT_FALSE(equal(one.left, Renderer(scene, config).render(standing(), 0.0, 6).left));
  config.seed = 2;
  EXPECT_FALSE(equal(one.left, Renderer(scene, config).render(standing(), 0.0, 5).left));
}

TEST(Renderer, ImageNoiseHasTheStatedSize) {
  RendererConfig config = smallConfig();
  config.noise = 4.0;
  const Scene sky({wallAt(20.0f, -1, 1, -200, -199)});
  const StereoFrame first = Renderer(sky, config).render(standing(), 0.0, 1);
  const StereoFrame second = Renderer(sky, config).render(standing(), 0.0, 2);
  cv::Mat difference;
  cv::subtract(first.left, second.left, difference, cv::noArray(), CV_32F);
  cv::Scalar mean, deviation;
  cv::meanStdDev(difference, mean, deviation);
  const double light = cv::mean(first.left)[0] / 255.0;
  // Shot noise on top of read noise, each of the two images with its own.
  EXPECT_NEAR(deviation[0] / std::sqrt(2.0), 4.0 * std::sqrt(0.3 + 1.4 * light), 0.3);
  EXPECT_NEAR(mean[0], 0.0, 0.5);
}

TEST(Renderer, ExposureRatioBrightensTheRightImage) {
  RendererConfig config = smallConfig();
  const Scene scene({wallAt(20.0f, -100, 100, -100, 100)});
  config.right_gain = 1.3;
  const StereoFrame frame = Renderer(scene, config).render(standing(), 0.0, 0);
  EXPECT_NEAR(cv::mean(frame.right)[0] / cv::mean(frame.left)[0], 1.3, 0.05);
}

TEST(Renderer, MotionBlurSmearsAlongTheMotionOnly) {
  // Turning about the vertical: a vertical edge gets soft, a horizontal one stays sharp.
  SmoothProfile course;
  course.addChange(0.0, 2.0, 0.5, 1.5);  // 1 rad/s
  const Trajectory turning(SmoothProfile(0.0), SmoothProfile(), course, {0, 0, 10}, 2.0);
  RendererConfig config = smallConfig();
  config.noise = 0.0;
  config.samples = 32;
  const Scene scene({wallAt(20.0f, -100, 100, -100, 100)});
  const auto steps = [&](double exposure) {
    config.exposure_time = exposure;
    const cv::Mat image = Renderer(scene, config).render(turning, 1.0, 0).left;
    cv::Mat horizontal, vertical;
    cv::absdiff(image.colRange(1, 96), image.colRange(0, 95), horizontal);
    cv::absdiff(image.rowRange(1, 54), image.rowRange(0, 53), vertical);
    return std::vector<double>{cv::mean(horizontal)[0], cv::mean(vertical)[0]};
  };
  const std::vector<double> sharp = steps(0.0);
  const std::vector<double> blurred = steps(0.06);  // 4.5 pixels
  EXPECT_LT(blurred[0], 0.6 * sharp[0]);
  EXPECT_GT(blurred[1], 0.6 * sharp[1]);
}

}  // namespace
}  // namespace simulation
}  // namespace adaptive_grid_stereo
