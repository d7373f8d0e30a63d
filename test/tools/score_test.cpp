#include "score.h"

#include <limits>

#include <gtest/gtest.h>

namespace adaptive_grid_stereo {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

TEST(Score, CountsInvalidAsBadAndValidApart) {
  // Errors 0, 0.75, 2.5, none, and one outside the mask.
  const cv::Mat truth = (cv::Mat_<float>(1, 6) << 10, 10, 10, 10, 10, kInf);
  const cv::Mat disparity = (cv::Mat_<float>(1, 6) << 10, 10.75f, 7.5f, kInf, 50, 10);
  const cv::Mat mask = (cv::Mat_<uchar>(1, 6) << 255, 255, 255, 255, 0, 255);
  const Score result = score(disparity, truth, mask, cv::Rect(0, 0, 6, 1));
  EXPECT_EQ(result.pixels, 4);
  EXPECT_DOUBLE_EQ(result.bad[0], 75.0);  // over 0.5: 0.75, 2.5, none
  EXPECT_DOUBLE_EQ(result.bad[1], 50.0);
  EXPECT_DOUBLE_EQ(result.bad[2], 50.0);
  EXPECT_DOUBLE_EQ(result.bad[3], 25.0);
  EXPECT_DOUBLE_EQ(result.bad_valid[2], 100.0 / 3.0);
  EXPECT_DOUBLE_EQ(result.density, 75.0);
  EXPECT_DOUBLE_EQ(result.average_error, (0.0 + 0.75 + 2.5) / 3.0);
}

TEST(Score, AnErrorOfExactlyTheThresholdIsGood) {
  const cv::Mat truth(1, 1, CV_32FC1, cv::Scalar(5.0f));
  const cv::Mat disparity(1, 1, CV_32FC1, cv::Scalar(7.0f));
  const cv::Mat mask(1, 1, CV_8UC1, cv::Scalar(255));
  const Score result = score(disparity, truth, mask, cv::Rect(0, 0, 1, 1));
  EXPECT_DOUBLE_EQ(result.bad[1], 100.0);
  EXPECT_DOUBLE_EQ(result.bad[2], 0.0);
}

TEST(Score, OnlyTheBoxCounts) {
  cv::Mat truth(4, 4, CV_32FC1, cv::Scalar(5.0f));
  cv::Mat disparity = truth.clone();
  disparity.at<float>(0, 0) = 90.0f;
  const cv::Mat mask(4, 4, CV_8UC1, cv::Scalar(255));
  EXPECT_DOUBLE_EQ(score(disparity, truth, mask, cv::Rect(1, 1, 2, 2)).bad[2], 0.0);
  EXPECT_DOUBLE_EQ(score(disparity, truth, mask, cv::Rect(0, 0, 2, 2)).bad[2], 25.0);
  EXPECT_EQ(score(disparity, truth, mask, cv::Rect(3, 3, 9, 9)).pixels, 1);
  EXPECT_EQ(score(disparity, truth, mask, cv::Rect()).pixels, 0);
}

TEST(Score, MeansLeaveOutScenesWithoutPixels) {
  Score a;
  a.pixels = 10;
  a.bad[2] = 4.0;
  Score b;
  b.pixels = 1000;
  b.bad[2] = 8.0;
  const Score mean = meanScore({a, Score(), b});
  EXPECT_DOUBLE_EQ(mean.bad[2], 6.0);
  EXPECT_EQ(mean.pixels, 1010);
  EXPECT_EQ(meanScore({}).pixels, 0);
}

}  // namespace
}  // namespace adaptive_grid_stereo
