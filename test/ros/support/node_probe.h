#ifndef ADAPTIVE_GRID_STEREO_TEST_ROS_SUPPORT_NODE_PROBE_H
#define ADAPTIVE_GRID_STEREO_TEST_ROS_SUPPORT_NODE_PROBE_H

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <dynamic_reconfigure/Reconfigure.h>
#include <nav_msgs/Odometry.h>
#include <ros/ros.h>
#include <rosgraph_msgs/Log.h>
#include <sensor_msgs/Imu.h>

#include "support/synthetic_pair.h"

namespace adaptive_grid_stereo {

/// Longest wait for anything that must happen; a loaded machine needs some of it, a good run
/// little.
constexpr double kLongWait = 20.0;  // [s]

/// Polls until the condition holds; false after the wait.
inline bool waitUntil(const std::function<bool()>& condition, double seconds = kLongWait) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (ros::ok() && std::chrono::steady_clock::now() < end) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return condition();
}

/// Keeps what arrives on a topic. Needs a spinner.
template <typename Message>
class Listener {
 public:
  using ConstPtr = boost::shared_ptr<const Message>;

  Listener(ros::NodeHandle& handle, const std::string& topic)
      : subscriber_(handle.subscribe(topic, 1000, &Listener::onMessage, this)) {}
  ~Listener() { subscriber_.shutdown(); }

  /// Of /rosout the test itself is one of the publishers.
  bool waitConnected(std::uint32_t publishers = 1) const {
    return waitUntil([&] { return subscriber_.getNumPublishers() >= publishers; });
  }

  /// The first message for which `accept` holds, also of those that came already; null if none
  /// comes.
  ConstPtr waitFor(const std::function<bool(const Message&)>& accept, double seconds = kLongWait) {
    std::unique_lock<std::mutex> lock(mutex_);
    ConstPtr found;
    arrived_.wait_for(lock, std::chrono::duration<double>(seconds), [&] {
      const auto hit = std::find_if(messages_.begin(), messages_.end(),
                                    [&](const ConstPtr& message) { return accept(*message); });
      if (hit != messages_.end()) found = *hit;
      return found != nullptr;
    });
    return found;
  }

  ConstPtr waitForStamp(const ros::Time& stamp, double seconds = kLongWait) {
    return waitFor([&](const Message& message) { return message.header.stamp == stamp; }, seconds);
  }

  std::vector<ConstPtr> all() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return messages_;
  }
  std::size_t count() const { return all().size(); }
  void clear() {
    const std::lock_guard<std::mutex> lock(mutex_);
    messages_.clear();
  }

 private:
  void onMessage(const ConstPtr& message) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      messages_.push_back(message);
    }
    arrived_.notify_all();
  }

  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  std::vector<ConstPtr> messages_;
  ros::Subscriber subscriber_;  // last: it is gone before what it fills
};

/// A stereo camera and the motion sensors, published below a name space.
class FakeAircraft {
 public:
  FakeAircraft(ros::NodeHandle& handle, const std::string& name_space)
      : left(handle.advertise<sensor_msgs::Image>(name_space + "/left/image_rect", 100)),
        right(handle.advertise<sensor_msgs::Image>(name_space + "/right/image_rect", 100)),
        left_info(handle.advertise<sensor_msgs::CameraInfo>(name_space + "/left/camera_info", 100)),
        right_info(
            handle.advertise<sensor_msgs::CameraInfo>(name_space + "/right/camera_info", 100)),
        odom(handle.advertise<nav_msgs::Odometry>(name_space + "/odom", 100)),
        imu(handle.advertise<sensor_msgs::Imu>(name_space + "/imu", 100)) {}

  std::uint32_t imageSubscribers() const {
    return std::min({left.getNumSubscribers(), right.getNumSubscribers(),
                     left_info.getNumSubscribers(), right_info.getNumSubscribers()});
  }
  bool waitSubscribed(std::uint32_t subscribers = 1) const {
    return waitUntil([&] { return imageSubscribers() >= subscribers; });
  }
  bool waitIdle() const {
    return waitUntil([this] {
      return left.getNumSubscribers() + right.getNumSubscribers() + left_info.getNumSubscribers() +
                 right_info.getNumSubscribers() ==
             0;
    });
  }

  void publish(const StereoPair& pair) {
    left.publish(pair.left);
    right.publish(pair.right);
    left_info.publish(pair.left_info);
    right_info.publish(pair.right_info);
  }

  /// Straight or turning flight around `stamp`: odometry and IMU, body FLU.
  void publishMotion(const ros::Time& stamp, double speed, double yaw_rate) {
    for (int i = -40; i <= 10; ++i) {
      publishOdometry(stamp + ros::Duration(0.01 * i), speed, yaw_rate);
      publishImu(stamp + ros::Duration(0.01 * i), yaw_rate);
    }
  }
  void publishOdometry(const ros::Time& stamp, double speed, double yaw_rate) {
    nav_msgs::Odometry message;
    message.header.stamp = stamp;
    message.header.frame_id = "odom";
    message.child_frame_id = "base_link";
    message.pose.pose.orientation.w = 1.0;
    message.twist.twist.linear.x = speed;
    message.twist.twist.angular.z = yaw_rate;
    odom.publish(message);
  }
  void publishImu(const ros::Time& stamp, double yaw_rate) {
    sensor_msgs::Imu message;
    message.header.stamp = stamp;
    message.header.frame_id = "base_link";
    message.orientation.w = 1.0;
    message.angular_velocity.z = yaw_rate;
    message.linear_acceleration.z = 9.81;
    imu.publish(message);
  }

  ros::Publisher left;
  ros::Publisher right;
  ros::Publisher left_info;
  ros::Publisher right_info;
  ros::Publisher odom;
  ros::Publisher imu;
};

/// Sets parameters of a node by dynamic_reconfigure; false if the service fails. `response` gets
/// the values in force.
inline bool reconfigure(const std::string& node, const dynamic_reconfigure::Config& config,
                        dynamic_reconfigure::Config* response = nullptr) {
  dynamic_reconfigure::Reconfigure call;
  call.request.config = config;
  if (!ros::service::waitForService(node + "/set_parameters", ros::Duration(kLongWait))) {
    return false;
  }
  if (!ros::service::call(node + "/set_parameters", call)) return false;
  if (response != nullptr) *response = call.response.config;
  return true;
}

inline void addInt(dynamic_reconfigure::Config& config, const std::string& name, int value) {
  dynamic_reconfigure::IntParameter parameter;
  parameter.name = name;
  parameter.value = value;
  config.ints.push_back(parameter);
}

inline void addDouble(dynamic_reconfigure::Config& config, const std::string& name, double value) {
  dynamic_reconfigure::DoubleParameter parameter;
  parameter.name = name;
  parameter.value = value;
  config.doubles.push_back(parameter);
}

/// Stamps of a test's own clock: each call is a tenth of a second later.
class StampSource {
 public:
  ros::Time next() { return stamp_ += ros::Duration(0.1); }

 private:
  ros::Time stamp_ = ros::Time(1000.0);
};

/// Whether the node's log has a line of at least this level with all the words.
inline bool logged(Listener<rosgraph_msgs::Log>& log, std::uint8_t level,
                   const std::vector<std::string>& words) {
  return log.waitFor([&](const rosgraph_msgs::Log& line) {
    return line.level >= level &&
           std::all_of(words.begin(), words.end(), [&](const std::string& word) {
             return line.msg.find(word) != std::string::npos;
           });
  }) != nullptr;
}

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_TEST_ROS_SUPPORT_NODE_PROBE_H
