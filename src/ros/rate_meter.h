#ifndef ADAPTIVE_GRID_STEREO_SRC_ROS_RATE_METER_H
#define ADAPTIVE_GRID_STEREO_SRC_ROS_RATE_METER_H

#include <algorithm>
#include <cstddef>
#include <deque>

namespace adaptive_grid_stereo {

/// Rate of `count` events, the first and the last of which came at those times [s], as seen now
/// [Hz]; 0 if there are fewer than two. A source that has stopped does not keep its rate.
inline double rateOf(std::size_t count, double first, double last, double now) {
  if (count < 2) return 0.0;
  const double intervals = static_cast<double>(count - 1);
  const double gap = (last - first) / intervals;
  const double span = std::max(last - first, now - first - 2.0 * gap);
  return span > 0.0 ? intervals / span : 0.0;
}

/// Rate of events over the last seconds. Not thread safe.
class RateMeter {
 public:
  static constexpr double kWindow = 5.0;  // [s]

  void tick(double now) {
    times_.push_back(now);
    forget(now);
  }

  /// [Hz]; 0 while there are fewer than two events in the window.
  double rate(double now) {
    forget(now);
    return times_.empty() ? 0.0 : rateOf(times_.size(), times_.front(), times_.back(), now);
  }

  void clear() { times_.clear(); }

 private:
  void forget(double now) {
    while (!times_.empty() && times_.front() < now - kWindow) times_.pop_front();
  }

  std::deque<double> times_;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SRC_ROS_RATE_METER_H
