// Images, truth and masks of a stereo set, as files of any content.

#include <opencv2/core/utils/logger.hpp>

#include "dataset.h"
#include "test/fuzz/fuzz_input.h"
#include "test/fuzz/temporary_file.h"

namespace {

using namespace adaptive_grid_stereo;

/// The next file: its length in 16 bits, then its bytes.
void writeNext(fuzz::FuzzInput* input, const fuzz::TemporaryFile& file) {
  const std::size_t size = std::min<std::size_t>(input->bits<std::uint16_t>(), input->left());
  std::vector<std::uint8_t> bytes(size);
  for (std::uint8_t& byte : bytes) byte = input->bits<std::uint8_t>();
  file.write(bytes.data(), bytes.size());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const bool quiet = [] {
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    setenv("OPENCV_IO_MAX_IMAGE_PIXELS", "65536", 1);
    return true;
  }();
  static_cast<void>(quiet);
  static const fuzz::TemporaryFile image(".pgm"), pfm(".pfm"), grey(".png");
  fuzz::FuzzInput input(data, size);
  const int layout = input.between(0, 4);
  writeNext(&input, image);
  writeNext(&input, input.flag() ? grey : pfm);
  Scene scene;
  scene.layout = static_cast<DatasetLayout>(layout);
  scene.name = input.flag() ? "venus" : "cones";
  scene.left = scene.right = image.path();
  scene.truth = input.flag() ? grey.path() : pfm.path();
  scene.visible_truth = input.flag() ? scene.truth : "";
  scene.right_truth = input.flag() ? scene.truth : "";
  scene.visible_mask = input.flag() ? image.path() : "";
  scene.all_mask = input.flag() ? image.path() : "";
  scene.truth_scale = input.flag() ? 256.0 : 1.0;
  try {
    const LoadedScene loaded = loadScene(scene);
    fuzz::require(loaded.left.type() == CV_8UC1 && loaded.right.size() == loaded.left.size(),
                  "images that cannot be matched");
    for (const cv::Mat& part : {loaded.truth, loaded.visible, loaded.all}) {
      fuzz::require(part.empty() || part.size() == loaded.left.size(), "a truth of another size");
    }
  } catch (const std::runtime_error&) {
  }
  return 0;
}
