#ifndef ADAPTIVE_GRID_STEREO_SRC_ROS_MOTION_MESSAGES_H
#define ADAPTIVE_GRID_STEREO_SRC_ROS_MOTION_MESSAGES_H

#include <optional>
#include <string>

#include <geometry_msgs/TwistStamped.h>
#include <nav_msgs/Odometry.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/MagneticField.h>
#include <sensor_msgs/NavSatFix.h>

#include "adaptive_grid_stereo/guidance/motion_samples.h"

namespace adaptive_grid_stereo {

/// Each turns a message into a sample, or returns nothing and says in one sentence what is wrong
/// with the message: NaN or inf in the fields used, no stamp, no position fix. An orientation
/// counts only if its quaternion has length one (within a tenth) and its covariance does not deny
/// it (-1).
std::optional<ImuSample> toSample(const sensor_msgs::Imu& message, std::string* error);
std::optional<OdometrySample> toSample(const nav_msgs::Odometry& message, std::string* error);
std::optional<VelocitySample> toSample(const geometry_msgs::TwistStamped& message,
                                       std::string* error);
std::optional<FixSample> toSample(const sensor_msgs::NavSatFix& message, std::string* error);
std::optional<MagneticSample> toSample(const sensor_msgs::MagneticField& message,
                                       std::string* error);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SRC_ROS_MOTION_MESSAGES_H
