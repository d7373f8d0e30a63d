// Prints a checksum of the disparities of seeded image pairs, for each SIMD target: the lines after
// the target's name are the same on every machine. scripts/test_neon.sh compares those of ARM with
// those of this one.
//   print_checksums [TARGET]     all targets by default

#include <array>
#include <cstdio>

#include "adaptive_grid_stereo/matching/stereo_matcher.h"
#include "test/matching/checksum.h"

namespace {

using namespace adaptive_grid_stereo;

/// Noise, smoothed in integers, the right image shifted by another disparity in each third.
void makePair(int width, int height, std::uint32_t seed, cv::Mat* left, cv::Mat* right) {
  cv::Mat noise(height, width + 64, CV_8UC1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < noise.cols; ++x) {
      seed = seed * 1664525U + 1013904223U;
      const int before = x > 0 ? noise.at<std::uint8_t>(y, x - 1) : 128;
      noise.at<std::uint8_t>(y, x) =
          static_cast<std::uint8_t>((before + 3 * static_cast<int>(seed >> 24)) / 4);
    }
  }
  *left = noise.colRange(0, width).clone();
  *right = left->clone();
  for (int y = 0; y < height; ++y) {
    const int shift = 3 + 9 * (3 * y / height);
    noise.row(y).colRange(shift, shift + width).copyTo(right->row(y));
  }
}

void printFor(const std::string& target) {
  useSimdTarget(target);
  std::printf("%s\n", target.c_str());
  const std::array<std::array<int, 9>, 4> plans{{{16, 16, 16, 16, 16, 16, 16, 16, 16},
                                                 {4, 8, 4, 8, 16, 8, 4, 8, 4},
                                                 {16, 8, 4, 16, 8, 4, 16, 8, 4},
                                                 {4, 4, 4, 8, 8, 8, 16, 16, 16}}};
  const std::array<std::array<int, 2>, 3> sizes{{{160, 90}, {211, 77}, {64, 48}}};
  std::uint32_t seed = 1;
  for (const auto& [width, height] : sizes) {
    for (const auto& paths : plans) {
      for (const int range : {16, 64, 144}) {
        for (const CensusWindow window : {CensusWindow::k5x5, CensusWindow::k9x7}) {
          MatcherConfig config;
          config.disparity_range = range;
          config.min_disparity = -static_cast<int>(seed % 7);
          config.census_window = window;
          config.speckle_size = 20;
          config.uniqueness_ratio = seed % 3 * 4.0;
          config.min_contrast = seed % 2 * 2.0;
          config.threads = 1 + static_cast<int>(seed % 3);
          PathPlan plan;
          plan.column_edges = {0, width / 3, 2 * width / 3, width};
          plan.row_edges = {0, height / 3, 2 * height / 3, height};
          plan.paths = paths;
          cv::Mat left, right;
          makePair(width, height, seed++, &left, &right);
          StereoMatcher matcher(config);
          std::printf("%dx%d plan %d-%d range %d window %s: %016llx\n", width, height, paths[0],
                      paths[4], range, toString(window),
                      static_cast<unsigned long long>(
                          checksum(matcher.match(left, right, plan).disparity)));
        }
      }
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  for (const std::string& target : simdTargets()) {
    if (argc < 2 || target == argv[1]) printFor(target);
  }
  return 0;
}
