#ifndef ADAPTIVE_GRID_STEREO_MATCHING_PADDED_IMAGE_H
#define ADAPTIVE_GRID_STEREO_MATCHING_PADDED_IMAGE_H

#include <cstddef>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

namespace adaptive_grid_stereo {

/// Columns that a PaddedImage adds on either side.
constexpr int kImageMargin = 64;

/// A grey image whose edges are replicated, so that stages may read beyond them: kImageMargin
/// columns on either side, and any row (row(y) clamps y). Owns its memory and reuses it.
class PaddedImage {
 public:
  /// Takes the size of a CV_8UC1 image, and nothing else.
  void reserve(const cv::Mat& image);

  /// Copies rows [first_row, last_row) of an image of the reserved size; `mirrored` turns each row
  /// round (column 0 is then the image's last). Thread safe for disjoint rows.
  void copyRows(const cv::Mat& image, bool mirrored, int first_row, int last_row);

  /// Both, for the whole image.
  void assign(const cv::Mat& image, bool mirrored);

  int width() const { return width_; }
  int height() const { return height_; }

  /// Pixel (0, y); columns -kImageMargin .. n + kImageMargin - 1 may be read, where n is the width
  /// rounded up to a multiple of 64.
  const std::uint8_t* row(int y) const {
    const int inside = y < 0 ? 0 : y >= height_ ? height_ - 1 : y;
    return pixels_.data() + static_cast<std::size_t>(inside) * stride_ + kImageMargin;
  }

 private:
  int width_ = 0;
  int height_ = 0;
  std::size_t stride_ = 0;
  std::vector<std::uint8_t> pixels_;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_MATCHING_PADDED_IMAGE_H
