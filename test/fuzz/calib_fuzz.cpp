// Calibration files of the Middlebury kind.

#include <sstream>

#include "dataset.h"
#include "test/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace adaptive_grid_stereo;
  std::istringstream stream(std::string(reinterpret_cast<const char*>(data), size));
  try {
    const int range = readNdisp(stream);
    fuzz::require(range >= 0 && range <= 100000, "a range that the contract rules out");
  } catch (const std::runtime_error&) {
  }
  return 0;
}
