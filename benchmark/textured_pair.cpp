#include "textured_pair.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

namespace adaptive_grid_stereo {
namespace {

constexpr double kNoise = 2.0;  // [grey levels]

/// Texture of several scales, so that there is something to match at every distance.
cv::Mat makeTexture(int width, int height, cv::RNG* random) {
  cv::Mat texture(height, width, CV_32FC1, cv::Scalar(128.0));
  for (const int cell : {2, 6, 20, 60}) {
    cv::Mat coarse(std::max(2, height / cell), std::max(2, width / cell), CV_32FC1);
    random->fill(coarse, cv::RNG::NORMAL, 0.0, 18.0);
    cv::Mat fine;
    cv::resize(coarse, fine, texture.size(), 0.0, 0.0, cv::INTER_CUBIC);
    texture += fine;
  }
  return texture;
}

/// Disparity seen by the right camera: far at the top, near at the bottom, boxes standing on it.
cv::Mat makeDisparity(int width, int height, int disparity_range, cv::RNG* random) {
  cv::Mat disparity(height, width, CV_32FC1);
  const double far = 0.1 * disparity_range;
  const double near = 0.6 * disparity_range;
  for (int y = 0; y < height; ++y) {
    disparity.row(y).setTo(far + (near - far) * y / height);
  }
  for (int i = 0; i < 12; ++i) {
    const cv::Rect box(random->uniform(0, width), random->uniform(0, height), width / 10,
                       height / 6);
    const cv::Rect inside = box & cv::Rect(0, 0, width, height);
    disparity(inside).setTo(random->uniform(0.3, 0.8) * disparity_range);
  }
  return disparity;
}

cv::Mat withNoise(const cv::Mat& image, cv::RNG* random) {
  cv::Mat noise(image.size(), CV_32FC1);
  random->fill(noise, cv::RNG::NORMAL, 0.0, kNoise);
  cv::Mat grey;
  cv::Mat(image + noise).convertTo(grey, CV_8U);
  return grey;
}

}  // namespace

TexturedPair makeTexturedPair(int width, int height, int disparity_range) {
  cv::RNG random(20260101);
  const cv::Mat texture = makeTexture(width, height, &random);
  const cv::Mat disparity = makeDisparity(width, height, disparity_range, &random);
  // The right image is drawn by looking up each of its pixels in the left one.
  cv::Mat map_x(height, width, CV_32FC1);
  cv::Mat map_y(height, width, CV_32FC1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      map_x.at<float>(y, x) = static_cast<float>(x) + disparity.at<float>(y, x);
      map_y.at<float>(y, x) = static_cast<float>(y);
    }
  }
  cv::Mat right;
  cv::remap(texture, right, map_x, map_y, cv::INTER_LINEAR, cv::BORDER_REFLECT);
  return {withNoise(texture, &random), withNoise(right, &random)};
}

}  // namespace adaptive_grid_stereo
