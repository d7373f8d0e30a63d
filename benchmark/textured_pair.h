#ifndef ADAPTIVE_GRID_STEREO_BENCHMARK_TEXTURED_PAIR_H
#define ADAPTIVE_GRID_STEREO_BENCHMARK_TEXTURED_PAIR_H

#include <opencv2/core.hpp>

namespace adaptive_grid_stereo {

struct TexturedPair {
  cv::Mat left;   // CV_8UC1
  cv::Mat right;  // CV_8UC1
};

/// A made-up rectified pair: slanted ground, boxes in front of it, fine and coarse texture, and
/// different noise in both images. Disparities fill [0.1, 0.8] * disparity_range. The same
/// arguments give the same images.
TexturedPair makeTexturedPair(int width, int height, int disparity_range);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_BENCHMARK_TEXTURED_PAIR_H
