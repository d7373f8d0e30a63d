#ifndef ADAPTIVE_GRID_STEREO_TOOLS_OUTPUT_FILE_H
#define ADAPTIVE_GRID_STEREO_TOOLS_OUTPUT_FILE_H

#include <string>
#include <vector>

namespace adaptive_grid_stereo {

/// A file that appears under its name only when it is whole: it is written beside it under a
/// temporary name, and commit() renames that. Without commit() the temporary file is removed, also
/// when SIGINT, SIGTERM or SIGHUP ends the process. Not thread safe.
class OutputFile {
 public:
  /// Throws std::runtime_error if `path` exists and `force` is false, if it is a directory, or if
  /// its folder does not exist. Devices such as /dev/stdout are written directly.
  OutputFile(const std::string& path, bool force);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Where to write; the file does not exist yet (but a device does).
  const std::string& writePath() const { return write_path_; }

  /// Gives the finished file its name. Throws std::runtime_error if that fails.
  void commit();

 private:
  std::string final_path_;
  std::string write_path_;
  bool force_;
  bool is_device_ = false;
  bool committed_ = false;
  int slot_ = -1;
};

/// Throws like OutputFile's constructor; for checking all names before the work begins.
void checkWritable(const std::string& path, bool force);

/// Writes `content` to `path` through an OutputFile. Throws std::runtime_error.
void writeFile(const std::string& path, const std::string& content, bool force);
void writeFile(const std::string& path, const std::vector<unsigned char>& content, bool force);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_TOOLS_OUTPUT_FILE_H
