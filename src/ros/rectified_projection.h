#ifndef ADAPTIVE_GRID_STEREO_SRC_ROS_RECTIFIED_PROJECTION_H
#define ADAPTIVE_GRID_STEREO_SRC_ROS_RECTIFIED_PROJECTION_H

#include <sensor_msgs/CameraInfo.h>

namespace adaptive_grid_stereo {

/// P of a camera_info, brought to the pixels of the image as published [px], and that image's size.
struct RectifiedProjection {
  double fx = 0.0;
  double fy = 0.0;
  double cx = 0.0;
  double cy = 0.0;
  /// -fx * baseline of the right camera [px m], 0 for the left one.
  double tx = 0.0;
  /// As the camera_info states it; 0: it does not say.
  unsigned width = 0;
  unsigned height = 0;
};

/// camera_info describes the full sensor; binning and region of interest lead to the image.
inline RectifiedProjection rectifiedProjection(const sensor_msgs::CameraInfo& info) {
  const double binning_x = info.binning_x > 0 ? info.binning_x : 1;
  const double binning_y = info.binning_y > 0 ? info.binning_y : 1;
  const bool has_roi = info.roi.width > 0 && info.roi.height > 0;
  const double offset_x = has_roi ? info.roi.x_offset : 0;
  const double offset_y = has_roi ? info.roi.y_offset : 0;

  RectifiedProjection projection;
  projection.fx = info.P[0] / binning_x;
  projection.fy = info.P[5] / binning_y;
  projection.cx = (info.P[2] - offset_x) / binning_x;
  projection.cy = (info.P[6] - offset_y) / binning_y;
  projection.tx = info.P[3] / binning_x;
  projection.width = static_cast<unsigned>((has_roi ? info.roi.width : info.width) / binning_x);
  projection.height = static_cast<unsigned>((has_roi ? info.roi.height : info.height) / binning_y);
  return projection;
}

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SRC_ROS_RECTIFIED_PROJECTION_H
