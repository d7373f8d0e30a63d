#ifndef ADAPTIVE_GRID_STEREO_TOOLS_PROGRESS_BAR_H
#define ADAPTIVE_GRID_STEREO_TOOLS_PROGRESS_BAR_H

#include <chrono>
#include <string>

namespace adaptive_grid_stereo {

/// One line on stderr with a bar, the rate and the time left. Silent where stderr is no terminal,
/// so that logs stay readable.
class ProgressBar {
 public:
  /// `unit` names what is counted, e.g. "frames"; `total` < 1 means that it is not known.
  ProgressBar(const std::string& unit, long total);
  ~ProgressBar();

  /// `done` so far; `note` (may be empty) stands at the end of the line. Drawn at most ten times a
  /// second.
  void update(long done, const std::string& note = "");

  /// Clears the line, so that other output may follow.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;
  std::string unit_;
  long total_;
  bool enabled_;
  bool drawn_ = false;
  Clock::time_point start_;
  Clock::time_point last_draw_;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_TOOLS_PROGRESS_BAR_H
