#include "pictures.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "output_file.h"

namespace adaptive_grid_stereo {
namespace {

constexpr double kRedError = 4.0;  // [px]

/// Scales [smallest, largest] to the colour map; pixels outside of `known` (CV_8UC1) become black.
cv::Mat colourValues(const cv::Mat& values, const cv::Mat& known, double smallest, double largest) {
  const double scale = 255.0 / std::max(1e-6, largest - smallest);
  cv::Mat index(values.size(), CV_8UC1, cv::Scalar(0));
  for (int y = 0; y < values.rows; ++y) {
    for (int x = 0; x < values.cols; ++x) {
      if (known.at<uchar>(y, x) == 0) continue;
      index.at<uchar>(y, x) = cv::saturate_cast<uchar>((values.at<float>(y, x) - smallest) * scale);
    }
  }
  cv::Mat colours;
  cv::applyColorMap(index, colours, cv::COLORMAP_JET);
  colours.setTo(cv::Scalar::all(0), known == 0);
  return colours;
}

cv::Mat finite(const cv::Mat& values) {
  cv::Mat known(values.size(), CV_8UC1);
  for (int y = 0; y < values.rows; ++y) {
    for (int x = 0; x < values.cols; ++x) {
      known.at<uchar>(y, x) = std::isfinite(values.at<float>(y, x)) ? 255 : 0;
    }
  }
  return known;
}

void checkFloat(const cv::Mat& image, const char* function) {
  if (image.type() != CV_32FC1 || image.empty()) {
    throw std::invalid_argument(std::string(function) + ": expected a CV_32FC1 image");
  }
}

}  // namespace

cv::Mat colourDisparity(const cv::Mat& disparity, double smallest, double largest) {
  checkFloat(disparity, "colourDisparity");
  return colourValues(disparity, finite(disparity), smallest, largest);
}

cv::Mat colourError(const cv::Mat& disparity, const cv::Mat& truth) {
  checkFloat(disparity, "colourError");
  checkFloat(truth, "colourError");
  const cv::Mat has_truth = finite(truth);
  const cv::Mat has_both = has_truth & finite(disparity);
  cv::Mat error(truth.size(), CV_32FC1, cv::Scalar(0));
  for (int y = 0; y < truth.rows; ++y) {
    for (int x = 0; x < truth.cols; ++x) {
      if (has_both.at<uchar>(y, x) == 0) continue;
      error.at<float>(y, x) = std::abs(disparity.at<float>(y, x) - truth.at<float>(y, x));
    }
  }
  cv::Mat colours = colourValues(error, has_both, 0.0, kRedError);
  colours.setTo(cv::Scalar::all(128), has_truth == 0);
  return colours;
}

void drawPlan(const PathPlan& plan, cv::Mat* picture) {
  const cv::Scalar white = cv::Scalar::all(255);
  for (int i = 1; i < 3; ++i) {
    cv::line(*picture, {plan.column_edges[i], 0}, {plan.column_edges[i], picture->rows - 1}, white);
    cv::line(*picture, {0, plan.row_edges[i]}, {picture->cols - 1, plan.row_edges[i]}, white);
  }
  for (int cell = 0; cell < 9; ++cell) {
    const int left = plan.column_edges[cell % 3];
    const int top = plan.row_edges[cell / 3];
    const int width = plan.column_edges[cell % 3 + 1] - left;
    const int height = plan.row_edges[cell / 3 + 1] - top;
    if (width < 24 || height < 16) continue;
    const std::string text = std::to_string(plan.paths[cell]);
    const cv::Point corner(left + 4, top + height - 4);
    cv::putText(*picture, text, corner, cv::FONT_HERSHEY_SIMPLEX, 0.5, cv::Scalar::all(0), 3,
                cv::LINE_AA);
    cv::putText(*picture, text, corner, cv::FONT_HERSHEY_SIMPLEX, 0.5, white, 1, cv::LINE_AA);
  }
}

void drawCaption(const std::string& text, cv::Mat* picture) {
  const int height = std::min(18, picture->rows);
  cv::Mat bar = picture->rowRange(0, height);
  bar.convertTo(bar, -1, 0.3);
  cv::putText(*picture, text, {4, height - 5}, cv::FONT_HERSHEY_SIMPLEX, 0.42, cv::Scalar::all(255),
              1, cv::LINE_AA);
}

void writePng(const std::string& path, const cv::Mat& picture, bool force) {
  std::vector<unsigned char> bytes;
  if (!cv::imencode(".png", picture, bytes)) {
    throw std::runtime_error(path + ": the picture cannot be encoded");
  }
  writeFile(path, bytes, force);
}

}  // namespace adaptive_grid_stereo
