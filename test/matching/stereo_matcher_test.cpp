#include "adaptive_grid_stereo/matching/stereo_matcher.h"

#ifdef __linux__
#include <sched.h>
#endif

#include <array>
#include <chrono>
#include <thread>

#include <gtest/gtest.h>

#include "test/matching/matcher_checks.h"
#include "test/matching/random_images.h"
#include "test/reference/reference_matcher.h"

namespace adaptive_grid_stereo {
namespace {

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

// As in flight: the size stays, and the grid moves.
TEST(StereoMatcher, followsThePlanFromFrameToFrame) {
  const ImagePair images = texturedPair(180, 60, 8, 3, 5);
  const std::array<int, 4> columns[] = {{0, 60, 120, 180}, {0, 70, 100, 180}, {0, 20, 150, 180}};
  const std::array<int, 9> paths[] = {{4, 8, 4, 8, 16, 8, 4, 8, 4}, {16, 8, 4, 16, 8, 4, 16, 8, 4}};
  for (const int threads : {1, 2, 3}) {
    MatcherConfig config;
    config.threads = threads;
    config.disparity_range = 16;
    StereoMatcher matcher(config);
    PathPlan plan = uniformPlan(180, 60, 16);
    for (const auto& edges : columns) {
      for (const auto& of_cells : paths) {
        plan.column_edges = edges;
        plan.paths = of_cells;
        EXPECT_TRUE(sameBits(reference::match(images.left, images.right, plan, config),
                             matcher.match(images.left, images.right, plan).disparity));
      }
    }
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
  const ImagePair images = texturedPair(kWidth, kHeight, 10, 6, 3);
  const PathPlan adaptive =
      plan({0, 200, 430, kWidth}, {0, 10, 30, kHeight}, {4, 8, 4, 8, 16, 8, 4, 8, 4});
  MatcherConfig config;
  config.disparity_range = 16;  // few: under a sanitizer, each of the frames takes its time
  config.threads = 1;
  StereoMatcher alone(config);
  const cv::Mat expected = alone.match(images.left, images.right, adaptive).disparity.clone();
  for (const bool one_core : {true, false}) {
    std::unique_ptr<OnOneCore> confined(one_core ? new OnOneCore : nullptr);
    for (const int threads : {2, 3, 4, 8}) {
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
