// The matcher against the plain reference: any parameters, plan, size, image, SIMD target and
// number of threads.

#include "adaptive_grid_stereo/matching/stereo_matcher.h"
#include "test/fuzz/fuzz_input.h"
#include "test/reference/reference_matcher.h"

namespace {

using namespace adaptive_grid_stereo;
using fuzz::FuzzInput;

MatcherConfig configOf(FuzzInput* input) {
  constexpr CensusWindow kWindows[] = {CensusWindow::k5x5, CensusWindow::k7x7, CensusWindow::k9x7};
  MatcherConfig config;
  config.disparity_range = 16 * input->between(1, 4);
  config.min_disparity = input->between(-40, 40);
  if (input->between(0, 15) == 0) config.min_disparity = input->between(-1030, 1030);
  config.census_window = kWindows[input->between(0, 2)];
  config.penalty_small = input->between(0, 130);
  config.penalty_large = input->between(0, 2001);
  config.penalty_large_min = input->between(0, 130);
  config.adaptive_penalty = input->flag();
  config.uniqueness_ratio = input->near(input->between(0, 99));
  config.disp12_max_diff = input->between(-1, 5);
  config.min_contrast = input->flag() ? 0.0 : input->near(input->between(0, 100));
  config.speckle_size = input->between(0, 60);
  config.speckle_range = input->between(0, 5);
  config.subpixel = input->flag();
  config.median_filter = input->flag();
  config.threads = input->between(1, 3);
  config.validate();
  return config;
}

std::array<int, 4> edgesOf(FuzzInput* input, int size) {
  const int a = input->between(0, size), b = input->between(0, size);
  return {0, std::min(a, b), std::max(a, b), size};
}

/// Pixels from the input first, then noise of some amplitude, so that flat, smooth and rough images
/// come up.
cv::Mat imageOf(FuzzInput* input, int width, int height) {
  cv::Mat image(height, width, CV_8UC1);
  const unsigned given = static_cast<unsigned>(input->between(0, 256));
  std::uint32_t state = input->bits<std::uint16_t>();
  const std::uint32_t amplitude = static_cast<std::uint32_t>(input->between(1, 256));
  const std::uint32_t base = input->bits<std::uint8_t>();
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      state = state * 1664525U + 1013904223U;
      const bool from_input = static_cast<unsigned>(y * width + x) < given && input->left() > 0;
      image.at<std::uint8_t>(y, x) =
          from_input ? input->bits<std::uint8_t>()
                     : static_cast<std::uint8_t>(base + (state >> 16) % amplitude);
    }
  }
  return image;
}

cv::Mat shifted(const cv::Mat& left, int disparity) {
  cv::Mat right = left.clone();
  for (int x = 0; x < left.cols; ++x) {
    left.col((x + disparity % left.cols + left.cols) % left.cols).copyTo(right.col(x));
  }
  return right;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzInput input(data, size);
  const int width = input.between(16, 48), height = input.between(16, 28);
  const MatcherConfig config = configOf(&input);
  PathPlan plan;
  plan.column_edges = edgesOf(&input, width);
  plan.row_edges = edgesOf(&input, height);
  for (int& paths : plan.paths) paths = 4 << input.between(0, 2);
  static const std::vector<std::string> targets = simdTargets();
  useSimdTarget(targets[static_cast<std::size_t>(input.between(0, 255)) % targets.size()]);
  const bool related = input.flag();
  const int disparity = input.between(-20, 60);
  const cv::Mat left = imageOf(&input, width, height);
  const cv::Mat right = related ? shifted(left, disparity) : imageOf(&input, width, height);

  StereoMatcher matcher(config);
  const cv::Mat found = matcher.match(left, right, plan).disparity;
  const cv::Mat expected = reference::match(left, right, plan, config);
  fuzz::require(found.size() == expected.size() && found.type() == expected.type(), "size or type");
  for (int y = 0; y < height; ++y) {
    fuzz::require(
        std::memcmp(found.ptr(y), expected.ptr(y), static_cast<std::size_t>(width) * 2) == 0,
        "the disparities are not the reference's");
  }
  return 0;
}
