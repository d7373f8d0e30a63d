#ifndef ADAPTIVE_GRID_STEREO_TEST_ROS_SUPPORT_SYNTHETIC_PAIR_H
#define ADAPTIVE_GRID_STEREO_TEST_ROS_SUPPORT_SYNTHETIC_PAIR_H

#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>

#include <stereo_msgs/DisparityImage.h>
#include <boost/make_shared.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "adaptive_grid_stereo/ros/stereo_pair.h"

namespace adaptive_grid_stereo {

/// A textured wall in front of a stereo rig, parallel to its images.
struct SyntheticRig {
  int width = 128;
  int height = 96;
  double focal_length = 100.0;  // [px]
  double baseline = 0.2;        // [m]
  double cx_left = 64.0;
  double cx_right = 64.0;
  std::string frame = "left_optical";
};

inline sensor_msgs::ImagePtr toMessage(const cv::Mat& image, const std::string& encoding,
                                       const std_msgs::Header& header) {
  auto message = boost::make_shared<sensor_msgs::Image>();
  message->header = header;
  message->width = static_cast<unsigned>(image.cols);
  message->height = static_cast<unsigned>(image.rows);
  message->encoding = encoding;
  message->step = static_cast<unsigned>(image.cols * image.elemSize());
  message->data.resize(static_cast<std::size_t>(message->step) * message->height);
  for (int y = 0; y < image.rows; ++y) {
    std::memcpy(&message->data[static_cast<std::size_t>(y) * message->step], image.ptr(y),
                message->step);
  }
  return message;
}

inline sensor_msgs::CameraInfoPtr makeInfo(const SyntheticRig& rig, bool right,
                                           const std_msgs::Header& header) {
  auto info = boost::make_shared<sensor_msgs::CameraInfo>();
  info->header = header;
  info->width = static_cast<unsigned>(rig.width);
  info->height = static_cast<unsigned>(rig.height);
  info->distortion_model = "plumb_bob";
  info->D.assign(5, 0.0);
  const double cx = right ? rig.cx_right : rig.cx_left;
  const double cy = rig.height / 2.0;
  info->K = {rig.focal_length, 0, cx, 0, rig.focal_length, cy, 0, 0, 1};
  info->R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info->P = {rig.focal_length,
             0,
             cx,
             right ? -rig.focal_length * rig.baseline : 0.0,
             0,
             rig.focal_length,
             cy,
             0,
             0,
             0,
             1,
             0};
  return info;
}

/// Random texture as wide as the left image and `shift` more columns.
inline cv::Mat makeTexture(const SyntheticRig& rig, int shift, std::uint64_t seed) {
  cv::Mat texture(rig.height, rig.width + shift, CV_8UC1);
  cv::RNG random(seed);
  random.fill(texture, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(texture, texture, cv::Size(3, 3), 0.8);
  return texture;
}

/// The wall at a disparity of `shift` [px], mono8.
inline StereoPair makePair(const SyntheticRig& rig, int shift, const ros::Time& stamp,
                           std::uint64_t seed = 1) {
  std_msgs::Header header;
  header.stamp = stamp;
  header.frame_id = rig.frame;
  const cv::Mat texture = makeTexture(rig, shift, seed);
  StereoPair pair;
  pair.left = toMessage(texture.colRange(0, rig.width), "mono8", header);
  pair.right = toMessage(texture.colRange(shift, shift + rig.width), "mono8", header);
  pair.left_info = makeInfo(rig, false, header);
  pair.right_info = makeInfo(rig, true, header);
  return pair;
}

/// Share of the pixels that both cameras see whose disparity is `expected` [px] to within 0.2 px.
inline double shareAt(const stereo_msgs::DisparityImage& disparity, double expected, int shift) {
  int good = 0;
  int all = 0;
  for (unsigned y = 0; y < disparity.image.height; ++y) {
    const auto* row =
        reinterpret_cast<const float*>(&disparity.image.data[y * disparity.image.step]);
    for (unsigned x = static_cast<unsigned>(shift); x < disparity.image.width; ++x) {
      ++all;
      if (std::abs(row[x] - expected) < 0.2) ++good;
    }
  }
  return all > 0 ? static_cast<double>(good) / all : 0.0;
}

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_TEST_ROS_SUPPORT_SYNTHETIC_PAIR_H
