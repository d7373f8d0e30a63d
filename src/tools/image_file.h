#ifndef ADAPTIVE_GRID_STEREO_TOOLS_IMAGE_FILE_H
#define ADAPTIVE_GRID_STEREO_TOOLS_IMAGE_FILE_H

#include <string>

#include <opencv2/core.hpp>

namespace adaptive_grid_stereo {

/// An image of any format that OpenCV reads. `flags` as for cv::imread. Throws std::runtime_error
/// that names the file if it is missing, no image, or larger than OpenCV reads.
cv::Mat readImage(const std::string& path, int flags);

struct ImagePair {
  cv::Mat left, right;
};

/// A pair as the node would see it: CV_8UC1, of 16 bits the 8 highest significant ones (mono16_bits
/// = 0). Throws as readImage(), and for other pixels.
ImagePair readGreyPair(const std::string& left, const std::string& right);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_TOOLS_IMAGE_FILE_H
