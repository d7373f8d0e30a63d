#ifndef ADAPTIVE_GRID_STEREO_SRC_ROS_RATE_METER_H
#define ADAPTIVE_GRID_STEREO_SRC_ROS_RATE_METER_H

#include <algorithm>
#include <deque>

namespace adaptive_grid_stereo {

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
    if (times_.size() < 2) return 0.0;
    // A source that has stopped does not keep its rate until the window is empty.
    const double span =
        std::max(times_.back() - times_.front(), now - times_.front() - 2.0 * meanGap());
    return span > 0.0 ? static_cast<double>(times_.size() - 1) / span : 0.0;
  }

  void clear() { times_.clear(); }

 private:
  double meanGap() const {
    return (times_.back() - times_.front()) / static_cast<double>(times_.size() - 1);
  }
  void forget(double now) {
    while (!times_.empty() && times_.front() < now - kWindow) times_.pop_front();
  }

  std::deque<double> times_;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SRC_ROS_RATE_METER_H
