#include "output_file.h"

#include <signal.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <system_error>

namespace fs = std::filesystem;

namespace adaptive_grid_stereo {
namespace {

// What a signal handler may touch: plain memory and unlink(), nothing that allocates.
struct TemporaryName {
  std::atomic<bool> in_use{false};
  std::array<char, 4096> path{};
};
std::array<TemporaryName, 8> temporary_names;

extern "C" void removeTemporariesAndDie(int signal_number) {
  for (TemporaryName& name : temporary_names) {
    if (name.in_use.load()) unlink(name.path.data());
  }
  // SA_RESETHAND has restored the default action, so the shell sees the true cause of death.
  raise(signal_number);
}

void catchSignals() {
  static const bool caught = [] {
    struct sigaction action {};
    action.sa_handler = removeTemporariesAndDie;
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    for (const int signal_number : {SIGINT, SIGTERM, SIGHUP}) {
      struct sigaction before {};
      sigaction(signal_number, nullptr, &before);
      // nohup and background jobs ignore signals on purpose.
      if (before.sa_handler != SIG_IGN) sigaction(signal_number, &action, nullptr);
    }
    return true;
  }();
  static_cast<void>(caught);
}

int rememberTemporary(const std::string& path) {
  catchSignals();
  for (std::size_t i = 0; i < temporary_names.size(); ++i) {
    TemporaryName& name = temporary_names[i];
    if (name.in_use.load() || path.size() >= name.path.size()) continue;
    std::memcpy(name.path.data(), path.c_str(), path.size() + 1);
    name.in_use.store(true);
    return static_cast<int>(i);
  }
  return -1;
}

void forgetTemporary(int slot) {
  if (slot >= 0) temporary_names[static_cast<std::size_t>(slot)].in_use.store(false);
}

bool isDevice(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  return fs::is_character_file(status) || fs::is_fifo(status) || fs::is_block_file(status);
}

template <typename Content>
void writeContent(const std::string& path, const Content& content, bool force) {
  OutputFile file(path, force);
  std::ofstream stream(file.writePath(), std::ios::binary);
  stream.write(reinterpret_cast<const char*>(content.data()),
               static_cast<std::streamsize>(content.size()));
  stream.close();
  if (!stream) throw std::runtime_error(path + ": cannot be written; is the disk full?");
  file.commit();
}

}  // namespace

void checkWritable(const std::string& path, bool force) {
  if (path.empty()) throw std::runtime_error("the name of an output file is empty");
  std::error_code error;
  if (fs::is_directory(path, error)) throw std::runtime_error(path + ": is a directory");
  if (isDevice(path)) return;
  if (fs::exists(path, error) && !force) {
    throw std::runtime_error(path + ": exists already; --force overwrites it");
  }
  const fs::path folder = fs::absolute(path).parent_path();
  if (!fs::is_directory(folder, error)) {
    throw std::runtime_error(path + ": the folder " + folder.string() + " does not exist");
  }
}

OutputFile::OutputFile(const std::string& path, bool force) : final_path_(path), force_(force) {
  checkWritable(path, force);
  is_device_ = isDevice(path);
  if (is_device_) {
    write_path_ = path;
    return;
  }
  // A symbolic link stays one: what it points to is replaced.
  std::error_code error;
  const fs::path resolved = fs::weakly_canonical(path, error);
  if (!error) final_path_ = resolved.string();
  write_path_ = final_path_ + ".partial-" + std::to_string(getpid());
  fs::remove(write_path_, error);
  slot_ = rememberTemporary(write_path_);
}

OutputFile::~OutputFile() {
  if (is_device_) return;
  if (!committed_) {
    std::error_code error;
    fs::remove(write_path_, error);
  }
  forgetTemporary(slot_);
}

void OutputFile::commit() {
  if (is_device_ || committed_) return;
  std::error_code error;
  if (!force_ && fs::exists(final_path_, error)) {
    throw std::runtime_error(final_path_ + ": appeared meanwhile; --force overwrites it");
  }
  fs::rename(write_path_, final_path_, error);
  if (error) throw std::runtime_error(final_path_ + ": cannot be written: " + error.message());
  committed_ = true;
}

void writeFile(const std::string& path, const std::string& content, bool force) {
  writeContent(path, content, force);
}

void writeFile(const std::string& path, const std::vector<unsigned char>& content, bool force) {
  writeContent(path, content, force);
}

}  // namespace adaptive_grid_stereo
