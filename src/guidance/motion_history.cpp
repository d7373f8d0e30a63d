#include "adaptive_grid_stereo/guidance/motion_history.h"

#include <algorithm>
#include <cmath>

namespace adaptive_grid_stereo {

Motion MotionHistory::ask(double stamp, const std::function<Motion(double)>& motion_at) {
  Motion motion = motion_at(stamp);
  motion.has_history = true;
  double from = stamp - kLongest;
  if (last_stamp_ <= stamp) from = std::max(from, last_stamp_);
  last_stamp_ = stamp;
  if (!std::isfinite(stamp)) return motion;
  // Instants are counted from time zero, hence the same in every run.
  for (double k = std::floor(from / kStep) + 1.0; k * kStep <= stamp; k += 1.0) {
    const Motion then = motion_at(k * kStep);
    motion.history.push_back(
        {k * kStep, then.valid, then.forward_speed, then.yaw_rate, then.pitch_rate});
  }
  return motion;
}

void MotionHistory::reset() { last_stamp_ = 0.0; }

}  // namespace adaptive_grid_stereo
