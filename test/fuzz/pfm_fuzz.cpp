// Portable float maps: any bytes give an image of the header's size, or std::runtime_error.

#include <sstream>

#include "pfm.h"
#include "test/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace adaptive_grid_stereo;
  std::istringstream stream(std::string(reinterpret_cast<const char*>(data), size));
  try {
    const cv::Mat image = readPfm(stream);
    fuzz::require(image.type() == CV_32FC1 && image.total() * 4 < size, "more pixels than bytes");
    std::ostringstream written;
    writePfm(written, image);
    std::istringstream again(written.str());
    const cv::Mat copy = readPfm(again);
    fuzz::require(copy.size() == image.size(), "another size after writing and reading");
    for (int y = 0; y < image.rows; ++y) {
      fuzz::require(std::memcmp(copy.ptr(y), image.ptr(y), image.cols * sizeof(float)) == 0,
                    "other pixels after writing and reading");
    }
  } catch (const std::runtime_error&) {
  }
  return 0;
}
