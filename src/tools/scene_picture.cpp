#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "evaluation_report.h"
#include "pictures.h"
#include "text_table.h"

namespace adaptive_grid_stereo {
namespace {

constexpr std::size_t kBad2 = 2;  // index in kBadThresholds

const Score& shownScore(const MethodResult& method) {
  return method.whole.visible.pixels > 0 ? method.whole.visible : method.whole.all;
}

/// Uniform 16, the adaptive plan with the fewest paths, the peer with the fewest bad pixels.
std::vector<const MethodResult*> chosenMethods(const SceneResult& result) {
  const MethodResult* uniform = nullptr;
  const MethodResult* adaptive = nullptr;
  const MethodResult* peer = nullptr;
  for (const MethodResult& method : result.methods) {
    if (method.method.is_peer) {
      if (!peer || shownScore(method).bad[kBad2] < shownScore(*peer).bad[kBad2]) peer = &method;
    } else if (method.method.uniform_paths == 16) {
      uniform = &method;
    } else if (method.method.uniform_paths == 0) {
      if (!adaptive || meanPaths(method.plan) < meanPaths(adaptive->plan)) adaptive = &method;
    }
  }
  std::vector<const MethodResult*> chosen;
  for (const MethodResult* method : {uniform, adaptive, peer}) {
    if (method) chosen.push_back(method);
  }
  return chosen;
}

std::string captionOf(const MethodResult& method) {
  std::string text = method.method.name + ": " + fixed(medianOf(method.time_ms), 1) + " ms";
  const Score& score = shownScore(method);
  if (score.pixels > 0) text += ", bad2 " + fixed(score.bad[kBad2], 2) + " %";
  return text;
}

double largestFinite(const cv::Mat& disparity, double otherwise) {
  double largest = 0.0;
  for (const float value : cv::Mat_<float>(disparity)) {
    if (std::isfinite(value)) largest = std::max(largest, static_cast<double>(value));
  }
  return largest > 0.0 ? largest : otherwise;
}

}  // namespace

cv::Mat scenePicture(const SceneResult& result) {
  const LoadedScene& images = result.images;
  const bool has_truth = !images.truth.empty();
  const std::vector<const MethodResult*> chosen = chosenMethods(result);
  const cv::Mat& reference = has_truth || chosen.empty() ? images.truth : chosen.front()->disparity;
  const double largest =
      reference.empty() ? result.disparity_range : largestFinite(reference, result.disparity_range);
  const cv::Mat no_truth(images.left.size(), CV_32FC1,
                         cv::Scalar(std::numeric_limits<float>::infinity()));
  const cv::Mat& truth = has_truth ? images.truth : no_truth;

  cv::Mat left;
  cv::cvtColor(images.left, left, cv::COLOR_GRAY2BGR);
  cv::Mat expected = colourDisparity(truth, 0.0, largest);
  drawCaption(result.scene.name + ", left image", &left);
  drawCaption(has_truth ? "ground truth" : "no ground truth", &expected);
  std::vector<cv::Mat> rows(1);
  cv::hconcat(left, expected, rows[0]);
  for (const MethodResult* method : chosen) {
    cv::Mat found = colourDisparity(method->disparity, 0.0, largest);
    cv::Mat error = colourError(method->disparity, truth);
    const bool adaptive = !method->method.is_peer && method->method.uniform_paths == 0;
    if (adaptive) drawPlan(method->plan, &found);
    drawCaption(captionOf(*method), &found);
    drawCaption("error: blue 0 px, red 4 px; black: no disparity", &error);
    cv::Mat row;
    cv::hconcat(found, error, row);
    rows.push_back(row);
  }
  cv::Mat picture;
  cv::vconcat(rows, picture);
  return picture;
}

}  // namespace adaptive_grid_stereo
