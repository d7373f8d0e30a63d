#ifndef ADAPTIVE_GRID_STEREO_TEST_FUZZ_STEREO_PAIR_CHECK_H
#define ADAPTIVE_GRID_STEREO_TEST_FUZZ_STEREO_PAIR_CHECK_H

#include <cmath>

#include "adaptive_grid_stereo/ros/conversions.h"
#include "adaptive_grid_stereo/ros/frame_processor.h"
#include "adaptive_grid_stereo/ros/input_check.h"
#include "test/fuzz/fuzz_input.h"

namespace adaptive_grid_stereo {
namespace fuzz {

inline void requireFits(const sensor_msgs::Image& image, unsigned width, unsigned height) {
  require(image.width == width && image.height == height, "an output of another size");
  require(image.data.size() == static_cast<std::size_t>(image.step) * height,
          "an output without its data");
}

/// Every pair is refused with a sentence, or processed into messages that are in order.
inline void checkAndProcess(const StereoPair& pair, const InputLimits& limits,
                            const ProcessorConfig& config) {
  const InputVerdict verdict = checkPair(pair, limits);
  require(verdict.ok() == verdict.error.empty(), "a refusal without a sentence");
  if (!verdict.ok()) return;
  const StereoGeometry& geometry = verdict.geometry;
  require(geometry.focal_length > 0.0 && std::isfinite(geometry.focal_length), "focal length");
  require(geometry.baseline > 0.0 && std::isfinite(geometry.baseline), "baseline");
  require(std::isfinite(geometry.center_offset), "center offset");
  const unsigned width = pair.left->width, height = pair.left->height;
  if (width > 64 || height > 64) return;  // accepted, but slow

  static FrameProcessor processor{ProcessorConfig()};
  processor.setConfig(config);
  processor.reset();
  WantedOutputs all;
  all.depth = all.overlay = all.disparity_color = true;
  const FrameResult frame = processor.process(pair, geometry, Motion());
  const SideOutputs side = processor.makeSideOutputs(frame, all);
  const stereo_msgs::DisparityImage& disparity = *frame.disparity;
  requireFits(disparity.image, width, height);
  requireFits(*side.depth, width, height);
  requireFits(*side.disparity_color, width, height);
  for (unsigned y = 0; y < height; ++y) {
    for (unsigned x = 0; x < width; ++x) {
      float value = 0.0F;
      std::memcpy(&value, &disparity.image.data[y * disparity.image.step + 4 * x], 4);
      require(std::isfinite(value), "a disparity that is no number");
    }
  }
}

}  // namespace fuzz
}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_TEST_FUZZ_STEREO_PAIR_CHECK_H
