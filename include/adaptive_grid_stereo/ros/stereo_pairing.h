#ifndef ADAPTIVE_GRID_STEREO_ROS_STEREO_PAIRING_H
#define ADAPTIVE_GRID_STEREO_ROS_STEREO_PAIRING_H

#include <cstdint>
#include <functional>
#include <memory>

#include <ros/time.h>

#include "adaptive_grid_stereo/ros/stereo_pair.h"

namespace adaptive_grid_stereo {

/// A pair with the time at which its left image was received, or recorded.
struct ReceivedPair {
  StereoPair pair;
  ros::Time received;
};

struct PairingOptions {
  bool approximate = false;
  double max_interval = 0.0;  // [s], approximate only; 0: no limit
  int queue_size = 5;
};

/// Puts left image, right image and their camera_infos together by their stamps, live and from
/// recordings alike: by message_filters, whose synchroniser is replaced when stamps jump back (a
/// recording that loops). Pairs whose stamp is not newer than the last one's are dropped. Needs
/// ros::Time::init(), but no master. Not thread safe.
class StereoPairing {
 public:
  /// on_jump comes, with the new stamp, before the first pair after a jump.
  StereoPairing(const PairingOptions& options, std::function<void(const ReceivedPair&)> on_pair,
                std::function<void(const ros::Time&)> on_jump);
  ~StereoPairing();

  void addLeft(const sensor_msgs::ImageConstPtr& image, const ros::Time& received);
  void addRight(const sensor_msgs::ImageConstPtr& image, const ros::Time& received);
  void addLeftInfo(const sensor_msgs::CameraInfoConstPtr& info, const ros::Time& received);
  void addRightInfo(const sensor_msgs::CameraInfoConstPtr& info, const ros::Time& received);

  /// Forgets what waits for its partners, and the last pair's stamp. Not from a callback.
  void startOver();

  /// Pairs that came twice or late.
  std::uint64_t dropped() const;
  /// Times that stamps jumped back.
  std::uint64_t clockJumps() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_ROS_STEREO_PAIRING_H
