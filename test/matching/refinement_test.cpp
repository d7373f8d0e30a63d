#include "adaptive_grid_stereo/matching/refinement.h"

#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "adaptive_grid_stereo/matching/stereo_matcher.h"
#include "test/reference/reference_matcher.h"

namespace adaptive_grid_stereo {
namespace {

cv::Mat randomDisparity(cv::Size size, unsigned seed) {
  cv::RNG rng(seed);
  cv::Mat coarse((size.height + 3) / 4, (size.width + 3) / 4, CV_16SC1), disparity;
  rng.fill(coarse, cv::RNG::UNIFORM, 0, 200);
  cv::resize(coarse, disparity, size, 0, 0, cv::INTER_NEAREST);
  cv::Mat holes(size, CV_8UC1);
  rng.fill(holes, cv::RNG::UNIFORM, 0, 5);
  disparity.setTo(kInvalidDisparity, holes == 0);
  return disparity;
}

bool equal(const cv::Mat& a, const cv::Mat& b) { return cv::countNonZero(a != b) == 0; }

TEST(SmallRegions, equalOpenCvAndTheReferenceOnEveryTarget) {
  SmallRegions regions;
  const std::vector<std::string> targets = simdTargets();
  for (unsigned seed = 1; seed < 60; ++seed) {
    useSimdTarget(targets[seed % targets.size()]);
    cv::RNG rng(seed);
    const cv::Mat disparity =
        randomDisparity(cv::Size(rng.uniform(1, 200), rng.uniform(1, 70)), seed);
    MatcherConfig config;
    config.median_filter = false;
    config.speckle_size = rng.uniform(1, 60);
    config.speckle_range = rng.uniform(0, 4);
    cv::Mat ours = disparity.clone(), theirs = disparity.clone();
    const int max_step = config.speckle_range * kDisparityScale;
    removeSmallRegions(config.speckle_size, max_step, &regions, &ours);
    cv::filterSpeckles(theirs, kInvalidDisparity, config.speckle_size, max_step);
    EXPECT_TRUE(equal(theirs, ours)) << "seed " << seed;
    EXPECT_TRUE(equal(reference::refine(disparity, cv::Mat(), config), ours)) << "seed " << seed;
  }
  useSimdTarget("");
}

TEST(SmallRegions, areTheSameForAnyNumberOfParts) {
  SmallRegions regions;
  for (unsigned seed = 1; seed < 40; ++seed) {
    cv::RNG rng(seed);
    const cv::Mat disparity =
        randomDisparity(cv::Size(rng.uniform(1, 90), rng.uniform(1, 70)), seed);
    const int max_size = rng.uniform(1, 60), max_step = rng.uniform(0, 70);
    cv::Mat whole = disparity.clone();
    removeSmallRegions(max_size, max_step, &regions, &whole);
    for (const int parts : {2, 3, 8, 100}) {
      cv::Mat joined = disparity.clone();
      regions.start(joined, max_step, parts);
      for (int part = parts - 1; part >= 0; --part) regions.find(part);
      regions.join();
      for (int part = 0; part < parts; ++part) regions.erase(part, max_size, &joined);
      EXPECT_TRUE(equal(whole, joined)) << "seed " << seed << ", " << parts << " parts";
    }
  }
}

TEST(Median, equalsTheReferenceOnEveryTarget) {
  for (const std::string& target : simdTargets()) {
    useSimdTarget(target);
    for (const cv::Size size : {cv::Size(16, 16), cv::Size(71, 23), cv::Size(1, 1)}) {
      const cv::Mat disparity = randomDisparity(size, 3);
      MatcherConfig config;
      config.speckle_size = 0;
      cv::Mat ours(size, CV_16SC1);
      medianOfValid(disparity, 0, size.height / 2, &ours);
      medianOfValid(disparity, size.height / 2, size.height, &ours);
      EXPECT_TRUE(equal(reference::refine(disparity, cv::Mat(), config), ours))
          << target << " " << size;
    }
  }
  useSimdTarget("");
}

TEST(Median, neitherFillsNorSmearsInvalidPixels) {
  cv::Mat disparity(5, 5, CV_16SC1, cv::Scalar(kInvalidDisparity)), result(5, 5, CV_16SC1);
  disparity.at<std::int16_t>(2, 2) = 100;
  medianOfValid(disparity, 0, 5, &result);
  EXPECT_TRUE(equal(disparity, result));
  disparity.setTo(100);
  disparity.at<std::int16_t>(2, 2) = kInvalidDisparity;
  medianOfValid(disparity, 0, 5, &result);
  EXPECT_TRUE(equal(disparity, result));
}

}  // namespace
}  // namespace adaptive_grid_stereo
