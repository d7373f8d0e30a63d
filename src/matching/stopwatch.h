#ifndef ADAPTIVE_GRID_STEREO_SRC_MATCHING_STOPWATCH_H
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_STOPWATCH_H

#include <chrono>

namespace adaptive_grid_stereo {

/// Time since it was made.
class Stopwatch {
 public:
  double milliseconds() const {
    return std::chrono::duration<double, std::milli>(Clock::now() - start_).count();
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_STOPWATCH_H
