#include "image_file.h"

#include <stdexcept>

#include <opencv2/imgcodecs.hpp>

namespace adaptive_grid_stereo {

cv::Mat readImage(const std::string& path, int flags) {
  cv::Mat image;
  try {
    image = cv::imread(path, flags);
  } catch (const cv::Exception& error) {
    // By sizes in the header beyond its limits, for one.
    throw std::runtime_error(path + ": cannot be read, OpenCV says: " + error.err);
  }
  if (image.empty()) throw std::runtime_error(path + ": is missing or no image that OpenCV reads");
  return image;
}

}  // namespace adaptive_grid_stereo
