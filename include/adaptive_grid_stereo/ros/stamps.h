#ifndef ADAPTIVE_GRID_STEREO_ROS_STAMPS_H
#define ADAPTIVE_GRID_STEREO_ROS_STAMPS_H

#include <algorithm>
#include <array>
#include <cstdint>

#include <ros/time.h>

namespace adaptive_grid_stereo {

/// later - earlier [s] for any two stamps. ros::Duration throws where they lie more than 68 years
/// apart, as a damaged stamp and a good one may.
inline double secondsBetween(const ros::Time& earlier, const ros::Time& later) {
  return 1e-9 * static_cast<double>(static_cast<std::int64_t>(later.toNSec()) -
                                    static_cast<std::int64_t>(earlier.toNSec()));
}

/// Sees from the stamps of the four inputs of a pair when their synchronisation has to start over.
class StampWatch {
 public:
  /// A step back by more than this is a jump [s].
  static constexpr double kJump = 0.5;
  /// message_filters can compare stamps that lie up to 2^31 / 1.1 s apart; beyond, it throws [s].
  static constexpr double kLongestSpan = 1.9e9;

  /// Whether `stamp`, the next one of that input, starts over: it lies before the input's newest
  /// one, or too far from any other to be compared. All stamps before it are then forgotten.
  bool startsOver(int input, const ros::Time& stamp) {
    const bool jumped =
        secondsBetween(stamp, newest_[input]) > kJump ||
        secondsBetween(std::min(earliest_, stamp), std::max(latest_, stamp)) > kLongestSpan;
    if (jumped) *this = StampWatch();
    newest_[input] = std::max(newest_[input], stamp);
    earliest_ = std::min(earliest_, stamp);
    latest_ = std::max(latest_, stamp);
    return jumped;
  }

 private:
  std::array<ros::Time, 4> newest_;
  ros::Time earliest_ = ros::TIME_MAX;
  ros::Time latest_;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_ROS_STAMPS_H
