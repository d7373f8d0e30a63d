#include "progress_bar.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace adaptive_grid_stereo {
namespace {

constexpr int kBarWidth = 30;

std::string clockTime(double seconds) {
  const long whole = std::lround(seconds);
  char text[32];
  std::snprintf(text, sizeof(text), "%ld:%02ld", whole / 60, whole % 60);
  return text;
}

}  // namespace

ProgressBar::ProgressBar(const std::string& unit, long total)
    : unit_(unit), total_(total), enabled_(isatty(STDERR_FILENO) == 1), start_(Clock::now()) {}

ProgressBar::~ProgressBar() { finish(); }

void ProgressBar::update(long done, const std::string& note) {
  if (!enabled_) return;
  const Clock::time_point now = Clock::now();
  if (drawn_ && now - last_draw_ < std::chrono::milliseconds(100)) return;
  last_draw_ = now;
  drawn_ = true;
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  const double rate = elapsed > 0.0 ? static_cast<double>(done) / elapsed : 0.0;
  if (total_ < 1) {
    std::fprintf(stderr, "\r\033[K%ld %s, %.1f/s %s", done, unit_.c_str(), rate, note.c_str());
  } else {
    const double share =
        std::clamp(static_cast<double>(done) / static_cast<double>(total_), 0.0, 1.0);
    const int filled = static_cast<int>(share * kBarWidth);
    const std::string bar = std::string(filled, '#') + std::string(kBarWidth - filled, '.');
    const std::string left =
        rate > 0.0 ? clockTime(static_cast<double>(total_ - done) / rate) : "-:--";
    std::fprintf(stderr, "\r\033[K[%s] %ld/%ld %s, %.1f/s, %s left %s", bar.c_str(), done, total_,
                 unit_.c_str(), rate, left.c_str(), note.c_str());
  }
  std::fflush(stderr);
}

void ProgressBar::finish() {
  if (!enabled_ || !drawn_) return;
  std::fprintf(stderr, "\r\033[K");
  std::fflush(stderr);
  drawn_ = false;
}

}  // namespace adaptive_grid_stereo
