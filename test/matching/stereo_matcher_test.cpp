#include "adaptive_grid_stereo/matching/stereo_matcher.h"

#ifdef __linux__
#include <sched.h>
#endif

#include <chrono>
#include <thread>

#include <gtest/gtest.h>

#include "test/matching/random_images.h"
#include "test/reference/reference_matcher.h"

namespace adaptive_grid_stereo {
namespace {

PathPlan plan(const std::array<int, 4>& columns, const std::array<int, 4>& rows,
              const std::array<int, 9>& paths) {
  PathPlan result;
  result.column_edges = columns;
  result.row_edges = rows;
  result.paths = paths;
  return result;
}

testing::AssertionResult sameBits(const cv::Mat& expected, const cv::Mat& actual) {
  if (expected.size() != actual.size() || expected.type() != actual.type()) {
    return testing::AssertionFailure() << "sizes or types differ";
  }
  int different = 0;
  std::string first;
  for (int y = 0; y < expected.rows; ++y) {
    for (int x = 0; x < expected.cols; ++x) {
      const int e = expected.at<std::int16_t>(y, x), a = actual.at<std::int16_t>(y, x);
      if (e == a) continue;
      if (different++ == 0) {
        first = "(" + std::to_string(x) + ", " + std::to_string(y) + "): expected " +
                std::to_string(e) + ", got " + std::to_string(a);
      }
    }
  }
  if (different == 0) return testing::AssertionSuccess();
  return testing::AssertionFailure() << different << " pixels differ, first " << first;
}

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

TEST(StereoMatcher, reusesItsBuffersForAnySequenceOfFrames) {
  MatcherConfig config;
  config.speckle_size = 10;
  StereoMatcher matcher(config);
  const int rounds[][4] = {{64, 40, 64, 16}, {33, 17, 16, 8},  {90, 24, 128, 16},
                           {64, 40, 64, 4},  {64, 40, 32, 16}, {20, 60, 64, 8}};
  for (const auto& round : rounds) {
    config.disparity_range = round[2];
    config.threads = 1 + round[0] % 3;
    matcher.setConfig(config);
    const ImagePair images = texturedPair(round[0], round[1], 12, 3, 5);
    const PathPlan uniform = uniformPlan(round[0], round[1], round[3]);
    EXPECT_TRUE(sameBits(reference::match(images.left, images.right, uniform, config),
                         matcher.match(images.left, images.right, uniform).disparity));
  }
}

// The calling thread, and threads that it starts, share one core as long as this lives.
class OnOneCore {
 public:
#ifdef __linux__
  OnOneCore() {
    sched_getaffinity(0, sizeof(before_), &before_);
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(sched_getcpu(), &one);
    sched_setaffinity(0, sizeof(one), &one);
  }
  ~OnOneCore() { sched_setaffinity(0, sizeof(before_), &before_); }

 private:
  cpu_set_t before_;
#endif
};

TEST(StereoMatcher, givesTheSameFromThreadsThatShareACore) {
  constexpr int kWidth = 640, kHeight = 41;
  const ImagePair images = texturedPair(kWidth, kHeight, 20, 6, 3);
  const PathPlan adaptive =
      plan({0, 200, 430, kWidth}, {0, 10, 30, kHeight}, {4, 8, 4, 8, 16, 8, 4, 8, 4});
  MatcherConfig config;
  config.threads = 1;
  StereoMatcher alone(config);
  const cv::Mat expected = alone.match(images.left, images.right, adaptive).disparity.clone();
  for (const bool one_core : {true, false}) {
    std::unique_ptr<OnOneCore> confined(one_core ? new OnOneCore : nullptr);
    for (const int threads : {2, 3, 8}) {
      config.threads = threads;
      StereoMatcher matcher(config);
      for (int frame = 0; frame < 20; ++frame) {
        ASSERT_TRUE(
            sameBits(expected, matcher.match(images.left, images.right, adaptive).disparity))
            << threads << " threads, frame " << frame << (one_core ? ", on one core" : "");
      }
    }
  }
}

TEST(StereoMatcher, endsWhenItIsCancelled) {
  const ImagePair images = texturedPair(400, 300, 20, 5, 1);
  for (const int threads : {1, 2, 5}) {
    MatcherConfig config;
    config.disparity_range = 128;
    config.threads = threads;
    StereoMatcher matcher(config);
    const PathPlan everywhere = uniformPlan(400, 300, 16);
    std::thread elsewhere([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      matcher.cancel();
    });
    EXPECT_THROW(for (;;) matcher.match(images.left, images.right, everywhere), MatchCancelled);
    elsewhere.join();
    EXPECT_THROW(matcher.match(images.left, images.right, everywhere), MatchCancelled);
  }
}

TEST(StereoMatcher, findsTheShiftOfATexture) {
  const ImagePair images = texturedPair(160, 80, 20, 6, 3);
  StereoMatcher matcher{MatcherConfig()};
  const MatchResult& result = matcher.match(images.left, images.right, uniformPlan(160, 80, 16));
  const cv::Mat disparity = toFloatDisparity(result);
  int good = 0, valid = 0, total = 0;
  for (int y = 0; y < 80; ++y) {
    if (std::abs(y - 40) < 5) continue;
    for (int x = 24; x < 160; ++x) {
      const float d = disparity.at<float>(y, x);
      ++total;
      valid += d >= 0.0f;
      good += std::abs(d - (y < 40 ? 6.0f : 20.0f)) < 0.75f;
    }
  }
  EXPECT_GT(valid, 0.97 * total);
  EXPECT_GT(good, 0.97 * total);
}

TEST(StereoMatcher, usesTheLeftColumns) {
  // Where x - d leaves the image there is no candidate, but smaller disparities remain.
  const ImagePair images = texturedPair(160, 60, 4, 4, 9);
  StereoMatcher matcher{MatcherConfig()};
  const cv::Mat disparity =
      toFloatDisparity(matcher.match(images.left, images.right, uniformPlan(160, 60, 16)));
  int good = 0;
  for (int y = 0; y < 60; ++y) {
    for (int x = 8; x < 64; ++x) good += std::abs(disparity.at<float>(y, x) - 4.0f) < 0.75f;
  }
  EXPECT_GT(good, 0.95 * 60 * 56);
}

TEST(StereoMatcher, marksInvalidPixelsByOneValueBelowTheSmallest) {
  ImagePair images = texturedPair(64, 40, 12, 3, 5);
  cv::RNG(5).fill(images.right, cv::RNG::UNIFORM, 0, 256);
  MatcherConfig config;
  config.min_disparity = -5;
  StereoMatcher matcher(config);
  const cv::Mat disparity =
      toFloatDisparity(matcher.match(images.left, images.right, uniformPlan(64, 40, 16)));
  int invalid = 0;
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 64; ++x) {
      const float d = disparity.at<float>(y, x);
      invalid += d == -6.0f;
      EXPECT_TRUE(d == -6.0f || d >= -5.5f) << d;
    }
  }
  EXPECT_GT(invalid, 0);
}

TEST(StereoMatcher, leavesFlatRegionsOutOnRequest) {
  ImagePair images = texturedPair(120, 60, 4, 4, 9);
  for (cv::Mat* image : {&images.left, &images.right}) image->rowRange(0, 30).setTo(200);
  MatcherConfig config;
  config.min_contrast = 2.0;
  StereoMatcher matcher(config);
  const cv::Mat disparity =
      matcher.match(images.left, images.right, uniformPlan(120, 60, 16)).disparity;
  EXPECT_EQ(0, cv::countNonZero(disparity.rowRange(0, 26) != kInvalidDisparity));
  EXPECT_GT(cv::countNonZero(disparity.rowRange(32, 60) != kInvalidDisparity), 28 * 100);
}

TEST(StereoMatcher, acceptsViewsIntoLargerImages) {
  const ImagePair images = texturedPair(100, 60, 12, 3, 5);
  const cv::Rect part(7, 5, 70, 50);
  StereoMatcher matcher{MatcherConfig()};
  const cv::Mat whole =
      matcher.match(images.left(part).clone(), images.right(part).clone(), uniformPlan(70, 50, 8))
          .disparity.clone();
  EXPECT_TRUE(sameBits(
      whole,
      matcher.match(images.left(part), images.right(part), uniformPlan(70, 50, 8)).disparity));
}

TEST(StereoMatcher, refusesWhatItCannotMatch) {
  StereoMatcher matcher{MatcherConfig()};
  const cv::Mat image(40, 64, CV_8UC1, cv::Scalar(0));
  EXPECT_THROW(matcher.match(image, image.colRange(0, 63), uniformPlan(64, 40, 16)),
               std::invalid_argument);
  EXPECT_THROW(matcher.match(cv::Mat(), cv::Mat(), uniformPlan(64, 40, 16)), std::invalid_argument);
  const cv::Mat colour(40, 64, CV_8UC3, cv::Scalar::all(0));
  EXPECT_THROW(matcher.match(colour, colour, uniformPlan(64, 40, 16)), std::invalid_argument);
  const cv::Mat tiny(15, 64, CV_8UC1, cv::Scalar(0));
  EXPECT_THROW(matcher.match(tiny, tiny, uniformPlan(64, 15, 16)), std::invalid_argument);
  EXPECT_THROW(matcher.match(image, image, uniformPlan(64, 41, 16)), std::invalid_argument);
  EXPECT_THROW(matcher.match(image, image, uniformPlan(64, 40, 5)), std::invalid_argument);
  MatcherConfig illegal;
  illegal.disparity_range = 17;
  EXPECT_THROW(matcher.setConfig(illegal), std::invalid_argument);
  EXPECT_THROW(StereoMatcher{illegal}, std::invalid_argument);
  // The next good frame is served.
  EXPECT_EQ(matcher.match(image, image, uniformPlan(64, 40, 16)).disparity.size(), image.size());
}

TEST(SimdTargets, areKnownByName) {
  ASSERT_FALSE(simdTargets().empty());
  EXPECT_EQ(simdTarget(), simdTargets().front());
  EXPECT_THROW(useSimdTarget("abacus"), std::invalid_argument);
}

}  // namespace
}  // namespace adaptive_grid_stereo
