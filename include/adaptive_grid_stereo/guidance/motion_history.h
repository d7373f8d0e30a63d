#ifndef ADAPTIVE_GRID_STEREO_GUIDANCE_MOTION_HISTORY_H
#define ADAPTIVE_GRID_STEREO_GUIDANCE_MOTION_HISTORY_H

#include <functional>

#include "adaptive_grid_stereo/guidance/motion.h"

namespace adaptive_grid_stereo {

/// Adds to the answers for a sequence of frames the motion at the fixed instants in between, so
/// that the flight state's memory does not depend on which frames were processed. Not thread safe.
class MotionHistory {
 public:
  static constexpr double kStep = 0.02;    // [s]
  static constexpr double kLongest = 2.0;  // looked back at most [s]

  /// The motion at `stamp` [s] with its history since the last question; after a step back in time,
  /// and at first, since kLongest before it.
  Motion ask(double stamp, const std::function<Motion(double)>& motion_at);

  void reset();

 private:
  double last_stamp_ = 0.0;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_GUIDANCE_MOTION_HISTORY_H
