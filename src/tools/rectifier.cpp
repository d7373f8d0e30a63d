#include "rectifier.h"

#include <algorithm>
#include <stdexcept>

#include <cv_bridge/cv_bridge.h>
#include <sensor_msgs/image_encodings.h>
#include <opencv2/imgproc.hpp>

#include "adaptive_grid_stereo/ros/conversions.h"

namespace adaptive_grid_stereo {

bool needsRectification(const std::string& topic, const sensor_msgs::CameraInfo& info) {
  const std::string name = topic.substr(topic.rfind('/') + 1);
  if (name.find("rect") != std::string::npos) return false;
  const bool distorted =
      std::any_of(info.D.begin(), info.D.end(), [](double value) { return value != 0.0; });
  // Drivers without calibration leave the rotation zero.
  const bool no_rotation =
      std::all_of(info.R.begin(), info.R.end(), [](double value) { return value == 0.0; });
  bool identity = true;
  for (std::size_t i = 0; i < info.R.size(); ++i) {
    identity = identity && info.R[i] == (i % 4 == 0 ? 1.0 : 0.0);
  }
  return distorted || !(no_rotation || identity);
}

sensor_msgs::ImageConstPtr Rectifier::rectify(const sensor_msgs::ImageConstPtr& raw,
                                              const sensor_msgs::CameraInfo& info) {
  const bool bayer = sensor_msgs::image_encodings::isBayer(raw->encoding);
  if (raw->width == 0 || raw->height == 0 || raw->step == 0 ||
      raw->data.size() < static_cast<std::size_t>(raw->step) * raw->height) {
    throw std::runtime_error("the raw image has fewer bytes than its size asks for");
  }
  if (!bayer) {
    const std::string fault = imageFault(*raw);
    if (!fault.empty()) throw std::runtime_error("the raw image " + fault);
  }
  if (info.width != raw->width || info.height != raw->height) {
    throw std::runtime_error("the camera_info is for " + std::to_string(info.width) + "x" +
                             std::to_string(info.height) + ", the raw image is " +
                             std::to_string(raw->width) + "x" + std::to_string(raw->height));
  }
  model_.fromCameraInfo(info);
  namespace encodings = sensor_msgs::image_encodings;
  const std::string& grey =
      encodings::bitDepth(raw->encoding) == 16 ? encodings::MONO16 : encodings::MONO8;
  const cv_bridge::CvImageConstPtr source =
      bayer ? cv_bridge::toCvCopy(raw, grey) : cv_bridge::toCvShare(raw);
  cv_bridge::CvImage rectified(source->header, source->encoding);
  model_.rectifyImage(source->image, rectified.image, cv::INTER_LINEAR);
  return rectified.toImageMsg();
}

}  // namespace adaptive_grid_stereo
