#ifndef ADAPTIVE_GRID_STEREO_SRC_ROS_MOUNTING_LOOKUP_H
#define ADAPTIVE_GRID_STEREO_SRC_ROS_MOUNTING_LOOKUP_H

#include <optional>
#include <string>

#include <ros/time.h>
#include <tf2/buffer_core.h>

#include "adaptive_grid_stereo/guidance/motion_estimator.h"

namespace adaptive_grid_stereo {

/// How the camera's optical frame sits on `body` at `stamp` [s] by TF, and how it turns against it
/// over the last `interval` [s]. Empty if TF does not connect the two. A transform that ends before
/// the stamp holds for `timeout` [s]; after that Mounting::error says so.
std::optional<Mounting> lookUpMounting(const tf2::BufferCore& tf, const std::string& optical,
                                       const std::string& body, double stamp, double interval,
                                       double timeout);

/// The stamp of the newest transform between the two where TF connects them, but not at `stamp`
/// [s].
std::optional<ros::Time> newestMounting(const tf2::BufferCore& tf, const std::string& optical,
                                        const std::string& body, double stamp);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SRC_ROS_MOUNTING_LOOKUP_H
