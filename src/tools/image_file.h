#ifndef ADAPTIVE_GRID_STEREO_TOOLS_IMAGE_FILE_H
#define ADAPTIVE_GRID_STEREO_TOOLS_IMAGE_FILE_H

#include <string>

#include <opencv2/core.hpp>

namespace adaptive_grid_stereo {

/// An image of any format that OpenCV reads. `flags` as for cv::imread. Throws std::runtime_error
/// that names the file if it is missing, no image, or larger than OpenCV reads.
cv::Mat readImage(const std::string& path, int flags);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_TOOLS_IMAGE_FILE_H
