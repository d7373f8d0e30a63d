#ifndef ADAPTIVE_GRID_STEREO_TOOLS_BAG_PAIRS_H
#define ADAPTIVE_GRID_STEREO_TOOLS_BAG_PAIRS_H

#include <functional>
#include <memory>

#include <ros/time.h>

#include "adaptive_grid_stereo/ros/stereo_pair.h"

namespace adaptive_grid_stereo {

/// A pair with the time at which its left image was recorded.
struct RecordedPair {
  StereoPair pair;
  ros::Time recorded;
};

struct PairingOptions {
  bool approximate = false;
  double max_interval = 0.0;  // [s], approximate only; 0: no limit
  int queue_size = 5;
};

/// Pairs recorded messages by the same synchronisers and rules as StereoSync does live: stamps that
/// are not newer than the last pair's are dropped, stamps that jump back start everything over.
/// Needs ros::Time::init(), but no master. Not thread safe.
class BagPairs {
 public:
  /// on_jump comes, with the new stamp, before the first pair after a jump.
  BagPairs(const PairingOptions& options, std::function<void(const RecordedPair&)> on_pair,
           std::function<void(const ros::Time&)> on_jump);
  ~BagPairs();

  void addLeft(const sensor_msgs::ImageConstPtr& image, const ros::Time& recorded);
  void addRight(const sensor_msgs::ImageConstPtr& image, const ros::Time& recorded);
  void addLeftInfo(const sensor_msgs::CameraInfoConstPtr& info, const ros::Time& recorded);
  void addRightInfo(const sensor_msgs::CameraInfoConstPtr& info, const ros::Time& recorded);

  /// Pairs that came twice or late.
  long dropped() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_TOOLS_BAG_PAIRS_H
