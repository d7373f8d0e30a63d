#include "image_file.h"

#include <stdexcept>
#include <utility>

#include <opencv2/imgcodecs.hpp>

#include "src/common/eight_bits.h"

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

ImagePair readGreyPair(const std::string& left, const std::string& right) {
  constexpr int kGrey = cv::IMREAD_GRAYSCALE | cv::IMREAD_ANYDEPTH;
  ImagePair pair{readImage(left, kGrey), readImage(right, kGrey)};
  const std::pair<const std::string&, cv::Mat&> sides[] = {{left, pair.left}, {right, pair.right}};
  for (const auto& [path, image] : sides) {
    if (image.depth() != CV_8U && image.depth() != CV_16U) {
      throw std::runtime_error(path + ": its pixels are " + cv::typeToString(image.type()) +
                               "; expected 8 or 16 bits");
    }
  }
  keepEightBits(0, &pair.left, &pair.right);
  return pair;
}

}  // namespace adaptive_grid_stereo
