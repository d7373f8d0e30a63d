#ifndef ADAPTIVE_GRID_STEREO_TEST_MATCHING_RANDOM_IMAGES_H
#define ADAPTIVE_GRID_STEREO_TEST_MATCHING_RANDOM_IMAGES_H

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace adaptive_grid_stereo {

struct ImagePair {
  cv::Mat left, right;
};

/// A textured pair whose upper and lower halves are shifted by different disparities, with noise,
/// so that all branches of the matcher are taken.
inline ImagePair texturedPair(int width, int height, int near, int far, unsigned seed) {
  cv::RNG rng(seed);
  const int margin = std::max(std::abs(near), std::abs(far));
  cv::Mat texture(height, width + 2 * margin, CV_8UC1);
  rng.fill(texture, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(texture, texture, cv::Size(3, 3), 0.8);
  ImagePair pair;
  pair.left = texture.colRange(margin, margin + width).clone();
  pair.right = cv::Mat(height, width, CV_8UC1);
  for (int y = 0; y < height; ++y) {
    const int d = y < height / 2 ? far : near;
    texture.row(y).colRange(margin + d, margin + d + width).copyTo(pair.right.row(y));
  }
  for (cv::Mat* image : {&pair.left, &pair.right}) {
    cv::Mat noise(image->size(), CV_8UC1);
    rng.fill(noise, cv::RNG::UNIFORM, 0, 8);
    *image += noise;
  }
  return pair;
}

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_TEST_MATCHING_RANDOM_IMAGES_H
