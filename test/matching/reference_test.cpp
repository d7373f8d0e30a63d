// The matcher against the reference, bit for bit.
#include "adaptive_grid_stereo/matching/simd_target.h"
#include "adaptive_grid_stereo/matching/stereo_matcher.h"

#include <string>

#include <gtest/gtest.h>

#include "test/matching/matcher_checks.h"
#include "test/matching/random_images.h"
#include "test/reference/reference_matcher.h"

namespace adaptive_grid_stereo {
namespace {

// Runs the matcher on every SIMD target and several numbers of threads against the reference.
void expectReference(const ImagePair& images, const PathPlan& path_plan, MatcherConfig config) {
  ASSERT_TRUE(MatcherConfig(config).validate().empty()) << config.validate().front();
  const cv::Mat expected = reference::match(images.left, images.right, path_plan, config);
  for (const std::string& target : simdTargets()) {
    useSimdTarget(target);
    for (const int threads : {1, 2, 5}) {
      config.threads = threads;
      StereoMatcher matcher(config);
      EXPECT_TRUE(sameBits(expected, matcher.match(images.left, images.right, path_plan).disparity))
          << "on " << target << " with " << threads << " threads";
    }
  }
  useSimdTarget("");
}

class ReferenceTest : public testing::Test {
 protected:
  ReferenceTest() : images_(texturedPair(61, 37, 13, 5, 1)) {
    config_.disparity_range = 32;
    config_.speckle_size = 12;
  }
  ImagePair images_;
  MatcherConfig config_;
};

TEST_F(ReferenceTest, uniformPlans) {
  for (const int paths : {4, 8, 16}) {
    expectReference(images_, uniformPlan(61, 37, paths), config_);
  }
}

TEST_F(ReferenceTest, forwardPlan) {
  expectReference(images_, plan({0, 20, 41, 61}, {0, 12, 25, 37}, {4, 8, 4, 8, 16, 8, 4, 8, 4}),
                  config_);
}

TEST_F(ReferenceTest, yawAndPitchPlans) {
  expectReference(images_, plan({0, 17, 44, 61}, {0, 12, 25, 37}, {16, 8, 4, 16, 8, 4, 16, 8, 4}),
                  config_);
  expectReference(images_, plan({0, 17, 44, 61}, {0, 12, 25, 37}, {4, 8, 16, 4, 8, 16, 4, 8, 16}),
                  config_);
  expectReference(images_, plan({0, 17, 44, 61}, {0, 9, 28, 37}, {16, 16, 16, 8, 8, 8, 4, 4, 4}),
                  config_);
  expectReference(images_, plan({0, 17, 44, 61}, {0, 9, 28, 37}, {4, 4, 4, 8, 8, 8, 16, 16, 16}),
                  config_);
}

// Wide enough for each thread to have columns of its own.
TEST_F(ReferenceTest, columnsSharedByThreads) {
  for (const int width : {128, 190, 331}) {
    const ImagePair wide = texturedPair(width, 22, 13, 5, width);
    const int w = width;
    expectReference(wide, uniformPlan(w, 22, 16), config_);
    expectReference(wide,
                    plan({0, w / 3, w - w / 3, w}, {0, 7, 15, 22}, {4, 8, 4, 8, 16, 8, 4, 8, 4}),
                    config_);
    expectReference(
        wide, plan({0, w - 70, w - 2, w}, {0, 2, 21, 22}, {16, 8, 4, 16, 8, 4, 16, 8, 4}), config_);
    expectReference(wide, plan({0, 63, 64, w}, {0, 4, 8, 22}, {4, 16, 8, 8, 4, 16, 16, 8, 4}),
                    config_);
  }
  config_.uniqueness_ratio = 10.0;
  config_.min_disparity = -7;
  expectReference(texturedPair(331, 17, 13, 5, 2), uniformPlan(331, 17, 8), config_);
}

// The rows that do not fill a band are the last ones of the downward sweep and the first ones of
// the upward one; wherever the two meet, they must be at the same rows.
TEST_F(ReferenceTest, rowsSharedByThreads) {
  for (const int height : {16, 17, 18, 19, 53, 54, 55}) {
    for (const int width : {90, 150}) {
      const ImagePair images = texturedPair(width, height, 13, 5, height);
      const int w = width, h = height;
      expectReference(images, uniformPlan(w, h, 16), config_);
      expectReference(
          images, plan({0, w / 3, w - w / 3, w}, {0, 1, h - 3, h}, {4, 8, 4, 8, 16, 8, 16, 4, 8}),
          config_);
    }
  }
}

TEST_F(ReferenceTest, narrowAndEmptyCells) {
  expectReference(images_, plan({0, 1, 60, 61}, {0, 1, 36, 37}, {4, 16, 4, 16, 4, 16, 8, 16, 8}),
                  config_);
  expectReference(images_, plan({0, 30, 31, 61}, {0, 18, 19, 37}, {4, 8, 4, 8, 16, 8, 4, 8, 4}),
                  config_);
  expectReference(images_, plan({0, 30, 30, 61}, {0, 0, 37, 37}, {4, 8, 4, 16, 8, 4, 4, 8, 4}),
                  config_);
}

TEST_F(ReferenceTest, censusWindows) {
  for (const CensusWindow window : {CensusWindow::k5x5, CensusWindow::k7x7, CensusWindow::k9x7}) {
    config_.census_window = window;
    expectReference(images_, uniformPlan(61, 37, 16), config_);
  }
}

TEST_F(ReferenceTest, disparityRanges) {
  for (const int range : {16, 48, 80, 128, 512}) {
    config_.disparity_range = range;
    expectReference(images_, uniformPlan(61, 37, 8), config_);
  }
  // Wide enough for columns whose disparities all stay inside, whether they fill whole vectors or
  // not.
  for (const int range : {48, 80, 96, 112, 144}) {
    config_.disparity_range = range;
    expectReference(texturedPair(230, 16, 13, 5, range), uniformPlan(230, 16, 16), config_);
    expectReference(texturedPair(230, 16, 13, 5, range), uniformPlan(230, 16, 4), config_);
  }
}

TEST_F(ReferenceTest, minDisparities) {
  for (const int min_disparity : {-40, -7, 3, 30, 70, -1024, 1024}) {
    config_.min_disparity = min_disparity;
    expectReference(images_, uniformPlan(61, 37, 16), config_);
  }
}

TEST_F(ReferenceTest, imageSizes) {
  const int sizes[][2] = {{16, 16}, {17, 16}, {16, 19}, {33, 18}, {129, 21}, {64, 16}};
  for (const auto& size : sizes) {
    const ImagePair images = texturedPair(size[0], size[1], 9, 2, 7);
    expectReference(images, uniformPlan(size[0], size[1], 16), config_);
    expectReference(images, uniformPlan(size[0], size[1], 4), config_);
  }
}

TEST_F(ReferenceTest, penalties) {
  for (const bool adaptive : {true, false}) {
    for (const int large : {1, 30, 127, 2000}) {
      for (const int small : {0, 9, 126}) {
        config_.adaptive_penalty = adaptive;
        config_.penalty_large = large;
        config_.penalty_small = small;
        config_.penalty_large_min = small + 1;
        config_.validate();
        expectReference(images_, uniformPlan(61, 37, 16), config_);
      }
    }
  }
}

// Ranges whose ends are those of vectors, where there is no cost beyond.
TEST_F(ReferenceTest, penaltiesAtTheEndsOfVectors) {
  for (const int range : {16, 32, 64, 128}) {
    for (const int small : {0, 9, 126}) {
      config_.disparity_range = range;
      config_.penalty_small = small;
      config_.validate();
      SCOPED_TRACE(std::to_string(range) + " disparities, P1 = " + std::to_string(small));
      expectReference(texturedPair(200, 17, 9, 4, range), uniformPlan(200, 17, 16), config_);
    }
  }
}

// Cells that meet where all disparities stay inside the right image.
TEST_F(ReferenceTest, bordersOfCellsFarFromThoseOfTheImage) {
  PathPlan plan = uniformPlan(230, 26, 8);
  plan.column_edges = {0, 150, 200, 230};
  plan.row_edges = {0, 9, 17, 26};
  plan.paths = {4, 8, 16, 16, 4, 8, 8, 16, 4};
  for (const int range : {32, 64, 80, 128}) {
    for (const double uniqueness : {0.0, 10.0}) {
      config_.disparity_range = range;
      config_.uniqueness_ratio = uniqueness;
      SCOPED_TRACE(std::to_string(range) + " disparities, uniqueness " +
                   std::to_string(uniqueness));
      expectReference(texturedPair(230, 26, 11, 6, range), plan, config_);
    }
  }
}

TEST_F(ReferenceTest, selectionAndRefinement) {
  for (const double uniqueness : {0.0, 5.0, 40.0, 99.0}) {
    for (const int difference : {-1, 0, 1, 3}) {
      config_.uniqueness_ratio = uniqueness;
      config_.disp12_max_diff = difference;
      expectReference(images_, uniformPlan(61, 37, 8), config_);
    }
  }
  config_.uniqueness_ratio = 0.0;
  for (const double contrast : {1.0, 9.7, 40.0}) {
    config_.min_contrast = contrast;
    expectReference(images_, uniformPlan(61, 37, 8), config_);
  }
  config_.min_contrast = 0.0;
  config_.subpixel = false;
  config_.median_filter = false;
  config_.speckle_size = 0;
  expectReference(images_, uniformPlan(61, 37, 16), config_);
}

TEST_F(ReferenceTest, randomParameters) {
  cv::RNG rng(20);
  for (int round = 0; round < 25; ++round) {
    const int width = rng.uniform(16, 90), height = rng.uniform(16, 40);
    MatcherConfig config;
    config.disparity_range = rng.uniform(1, 9) * 16;
    config.min_disparity = rng.uniform(-20, 20);
    config.penalty_small = rng.uniform(0, 60);
    config.penalty_large = rng.uniform(1, 2000);
    config.penalty_large_min = rng.uniform(1, 128);
    config.adaptive_penalty = rng.uniform(0, 2) == 1;
    config.uniqueness_ratio = rng.uniform(0, 3) * 4.0;
    config.disp12_max_diff = rng.uniform(-1, 4);
    config.speckle_size = rng.uniform(0, 30);
    config.speckle_range = rng.uniform(0, 4);
    config.validate();
    PathPlan random;
    const auto edges = [&](int size) {
      const int a = rng.uniform(0, size + 1), b = rng.uniform(0, size + 1);
      return std::array<int, 4>{0, std::min(a, b), std::max(a, b), size};
    };
    random.column_edges = edges(width);
    random.row_edges = edges(height);
    for (int& paths : random.paths) paths = 4 << rng.uniform(0, 3);
    SCOPED_TRACE(round);
    expectReference(texturedPair(width, height, rng.uniform(0, 20), rng.uniform(0, 20), round),
                    random, config);
  }
}

}  // namespace
}  // namespace adaptive_grid_stereo
