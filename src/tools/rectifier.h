#ifndef ADAPTIVE_GRID_STEREO_TOOLS_RECTIFIER_H
#define ADAPTIVE_GRID_STEREO_TOOLS_RECTIFIER_H

#include <string>

#include <image_geometry/pinhole_camera_model.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

namespace adaptive_grid_stereo {

/// Whether images of this topic are raw: their name does not say "rect", and the camera_info holds
/// distortion or a rotation.
bool needsRectification(const std::string& topic, const sensor_msgs::CameraInfo& info);

/// Rectifies the images of one camera as image_proc/rectify does (linear interpolation); Bayer
/// images are made grey first. Keeps its maps while the calibration stays the same. Not thread
/// safe.
class Rectifier {
 public:
  /// Throws std::runtime_error if the image's size is not the calibration's, or it cannot be
  /// rectified for another reason.
  sensor_msgs::ImageConstPtr rectify(const sensor_msgs::ImageConstPtr& raw,
                                     const sensor_msgs::CameraInfo& info);

 private:
  image_geometry::PinholeCameraModel model_;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_TOOLS_RECTIFIER_H
