#ifndef ADAPTIVE_GRID_STEREO_SRC_ROS_OUTPUTS_H
#define ADAPTIVE_GRID_STEREO_SRC_ROS_OUTPUTS_H

#include <functional>

#include <image_transport/image_transport.h>
#include <ros/node_handle.h>
#include <ros/publisher.h>

#include "adaptive_grid_stereo/ros/frame_processor.h"

namespace adaptive_grid_stereo {

/// The nodelet's output topics. publish() and wanted() may be called from another thread than the
/// one that built it.
class Outputs {
 public:
  /// on_change runs in the handle's callback queue whenever a subscriber comes or goes. A reader
  /// that is slow misses images once it is queue_size of them behind.
  Outputs(const ros::NodeHandle& handle, std::uint32_t queue_size, std::function<void()> on_change);

  bool anybodyListens() const;
  /// The side outputs that somebody listens to.
  WantedOutputs wanted() const;
  /// Hands the messages over without copying them, each only if somebody listens.
  void publish(const FrameResult& frame) const;
  void publish(const SideOutputs& side) const;
  /// No connection callback runs after it has returned.
  void stop();

 private:
  ros::NodeHandle handle_;
  image_transport::ImageTransport transport_;
  ros::Publisher disparity_;
  ros::Publisher grid_state_;
  image_transport::Publisher depth_;
  image_transport::Publisher overlay_;
  image_transport::Publisher disparity_color_;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SRC_ROS_OUTPUTS_H
