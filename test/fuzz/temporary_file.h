#ifndef ADAPTIVE_GRID_STEREO_TEST_FUZZ_TEMPORARY_FILE_H
#define ADAPTIVE_GRID_STEREO_TEST_FUZZ_TEMPORARY_FILE_H

#include <cstdint>
#include <fstream>
#include <string>

#include <unistd.h>

namespace adaptive_grid_stereo {
namespace fuzz {

/// A file in memory, for readers that want a path.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& suffix)
      : path_("/dev/shm/ags_fuzz_" + std::to_string(getpid()) + suffix) {}
  ~TemporaryFile() { unlink(path_.c_str()); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const std::string& path() const { return path_; }
  const std::string& write(const std::uint8_t* data, std::size_t size) const {
    std::ofstream file(path_, std::ios::binary | std::ios::trunc);
    file.write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
    return path_;
  }

 private:
  std::string path_;
};

}  // namespace fuzz
}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_TEST_FUZZ_TEMPORARY_FILE_H
