#ifndef ADAPTIVE_GRID_STEREO_ROS_STEREO_PAIR_H
#define ADAPTIVE_GRID_STEREO_ROS_STEREO_PAIR_H

#include <string>

#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

namespace adaptive_grid_stereo {

/// One rectified stereo pair as it arrived; the messages are shared and never modified.
struct StereoPair {
  sensor_msgs::ImageConstPtr left;
  sensor_msgs::ImageConstPtr right;
  sensor_msgs::CameraInfoConstPtr left_info;
  sensor_msgs::CameraInfoConstPtr right_info;
};

/// What the calibration says about a rectified pair, in pixels of the images as published (binning
/// and region of interest taken into account).
struct StereoGeometry {
  /// fx of the right camera's P, equal to the left one's [px], > 0.
  double focal_length = 0.0;
  /// Distance of the two cameras [m], > 0.
  double baseline = 0.0;
  /// cx_left - cx_right [px]; a point at infinity is found at this disparity.
  double center_offset = 0.0;
  /// Where the baseline comes from: "camera_info" or "parameter".
  std::string baseline_source;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_ROS_STEREO_PAIR_H
