#include "score.h"

#include <cmath>
#include <stdexcept>

namespace adaptive_grid_stereo {

Score score(const cv::Mat& disparity, const cv::Mat& truth, const cv::Mat& mask,
            const cv::Rect& box) {
  if (disparity.type() != CV_32FC1 || truth.type() != CV_32FC1 || mask.type() != CV_8UC1 ||
      disparity.size() != truth.size() || mask.size() != truth.size()) {
    throw std::invalid_argument(
        "score: disparity, truth and mask must be float, float and bytes "
        "of one size");
  }
  const cv::Rect inside = box & cv::Rect(cv::Point(0, 0), truth.size());
  Score result;
  long valid = 0;
  double error_sum = 0.0;
  std::array<long, kBadThresholds.size()> wrong{};
  for (int y = inside.y; y < inside.y + inside.height; ++y) {
    for (int x = inside.x; x < inside.x + inside.width; ++x) {
      const float expected = truth.at<float>(y, x);
      if (mask.at<uchar>(y, x) == 0 || !std::isfinite(expected)) continue;
      ++result.pixels;
      const float found = disparity.at<float>(y, x);
      if (!std::isfinite(found)) continue;
      ++valid;
      const float error = std::abs(found - expected);
      error_sum += error;
      for (std::size_t i = 0; i < wrong.size(); ++i) wrong[i] += error > kBadThresholds[i];
    }
  }
  if (result.pixels == 0) return result;
  const double missing = static_cast<double>(result.pixels - valid);
  for (std::size_t i = 0; i < wrong.size(); ++i) {
    result.bad[i] = 100.0 * (static_cast<double>(wrong[i]) + missing) / result.pixels;
    result.bad_valid[i] = valid > 0 ? 100.0 * static_cast<double>(wrong[i]) / valid : 0.0;
  }
  result.average_error = valid > 0 ? error_sum / valid : 0.0;
  result.density = 100.0 * static_cast<double>(valid) / result.pixels;
  return result;
}

Score meanScore(const std::vector<Score>& scores) {
  Score mean;
  double count = 0.0;
  for (const Score& one : scores) {
    if (one.pixels == 0) continue;
    count += 1.0;
    mean.pixels += one.pixels;
    for (std::size_t i = 0; i < mean.bad.size(); ++i) {
      mean.bad[i] += one.bad[i];
      mean.bad_valid[i] += one.bad_valid[i];
    }
    mean.average_error += one.average_error;
    mean.density += one.density;
  }
  if (count == 0.0) return mean;
  for (std::size_t i = 0; i < mean.bad.size(); ++i) {
    mean.bad[i] /= count;
    mean.bad_valid[i] /= count;
  }
  mean.average_error /= count;
  mean.density /= count;
  return mean;
}

}  // namespace adaptive_grid_stereo
