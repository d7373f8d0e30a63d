#include "adaptive_grid_stereo/matching/padded_image.h"

#include <algorithm>
#include <cstring>

namespace adaptive_grid_stereo {
namespace {

// Eight pixels at a time, which std::reverse_copy does not do.
void reverse(const std::uint8_t* source, int width, std::uint8_t* target) {
  int x = 0;
  for (; x + 8 <= width; x += 8) {
    std::uint64_t pixels;
    std::memcpy(&pixels, source + width - 8 - x, 8);
    pixels = __builtin_bswap64(pixels);
    std::memcpy(target + x, &pixels, 8);
  }
  std::reverse_copy(source, source + width - x, target + x);
}

}  // namespace

void PaddedImage::reserve(const cv::Mat& image) {
  width_ = image.cols;
  height_ = image.rows;
  stride_ = (static_cast<std::size_t>(width_) + 63) / 64 * 64 + 2 * kImageMargin;
  pixels_.resize(stride_ * height_);
}

void PaddedImage::copyRows(const cv::Mat& image, bool mirrored, int first_row, int last_row) {
  for (int y = first_row; y < last_row; ++y) {
    const std::uint8_t* source = image.ptr<std::uint8_t>(y);
    std::uint8_t* target = pixels_.data() + static_cast<std::size_t>(y) * stride_;
    std::uint8_t* pixels = target + kImageMargin;
    if (mirrored) {
      reverse(source, width_, pixels);
    } else {
      std::memcpy(pixels, source, width_);
    }
    std::memset(target, pixels[0], kImageMargin);
    std::memset(pixels + width_, pixels[width_ - 1], stride_ - kImageMargin - width_);
  }
}

void PaddedImage::assign(const cv::Mat& image, bool mirrored) {
  reserve(image);
  copyRows(image, mirrored, 0, image.rows);
}

}  // namespace adaptive_grid_stereo
