#ifndef ADAPTIVE_GRID_STEREO_ROS_MOTION_SUBSCRIBER_H
#define ADAPTIVE_GRID_STEREO_ROS_MOTION_SUBSCRIBER_H

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <geometry_msgs/TwistStamped.h>
#include <nav_msgs/Odometry.h>
#include <ros/node_handle.h>
#include <ros/time.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/MagneticField.h>
#include <sensor_msgs/NavSatFix.h>
#include <tf2_msgs/TFMessage.h>

#include "adaptive_grid_stereo/guidance/motion.h"
#include "adaptive_grid_stereo/guidance/motion_config.h"

namespace adaptive_grid_stereo {

/// What has come in from one source, for diagnostics.
struct MotionSourceStatus {
  std::string name;            // "imu", "odom", "gps_vel", "gps_fix", "mag"
  std::string topic;           // resolved; empty when fed with messages directly
  std::uint64_t received = 0;  // messages
  std::uint64_t invalid = 0;   // NaN, inf or no stamp: refused
  std::uint64_t duplicates = 0;
  std::uint64_t out_of_order = 0;
  std::uint64_t gaps = 0;         // longer than motion_timeout
  std::uint64_t clock_jumps = 0;  // backwards
  std::uint64_t future = 0;       // stamped ahead of the clock on arrival
  double last_stamp = 0.0;        // newest stamp [s]; 0 before the first message
  double rate = 0.0;              // [Hz], of the latest samples; 0 if unknown
  std::string last_error;         // one sentence on the latest refused message
};

/// State of all motion inputs.
struct MotionInputStatus {
  std::vector<MotionSourceStatus> sources;
  /// Where the camera's mounting came from at the last question: "tf", "camera_rpy", or a sentence.
  std::string mounting;
  /// What contradicts the declared axes, in one sentence; empty if nothing does.
  std::string warning;
};

/// Feeds a MotionEstimator from ROS and answers for the motion at an image's stamp. Messages come
/// from topics after subscribe(), or directly through the add() functions when a bag is processed
/// offline: both ways end in the same code, and the answer for a stamp depends only on the samples
/// around that stamp, so that a flight gives the same states live, replayed and offline.
/// Thread safe. Callbacks never throw.
class MotionSubscriber {
 public:
  explicit MotionSubscriber(const MotionConfig& config);
  ~MotionSubscriber();

  /// Subscribes imu, odom, gps/vel, gps/fix, mag in `nh` (give it a callback queue that images do
  /// not hold up), and TF. Calling it again replaces the subscriptions.
  void subscribe(ros::NodeHandle nh);
  void unsubscribe();

  /// Takes effect with the next question; samples are kept.
  void setConfig(const MotionConfig& config);

  void add(const sensor_msgs::Imu& message);
  void add(const nav_msgs::Odometry& message);
  void add(const geometry_msgs::TwistStamped& message);
  void add(const sensor_msgs::NavSatFix& message);
  void add(const sensor_msgs::MagneticField& message);
  void add(const tf2_msgs::TFMessage& message, bool is_static);

  /// The motion at an image's stamp. `left_optical_frame` is the frame_id of the left image; empty:
  /// the mounting is camera_rpy. Never blocks. Questions should come in the order of their stamps:
  /// the answer carries the motion since the last question (Motion::history), from which
  /// FlightStateMachine brings its memory up to date whatever frames were dropped in between.
  Motion motionAt(const ros::Time& stamp, const std::string& left_optical_frame);

  /// True if the sources in use have delivered all that counts for `stamp`; a silent source counts
  /// as having delivered.
  bool ready(const ros::Time& stamp, const std::string& left_optical_frame) const;

  /// Waits until ready(), at most MotionConfig::motion_wait [s] of wall time, then answers as
  /// motionAt(). For the worker of the live node.
  Motion waitForMotion(const ros::Time& stamp, const std::string& left_optical_frame);

  /// The images' stamps start over at `stamp` (a bag that loops): forgets the samples of before,
  /// and the transforms that are not static. Samples and transforms that belong to the new time may
  /// have arrived already, and stay.
  void startOver(const ros::Time& stamp);

  MotionInputStatus status() const;

 private:
  // At the start images may come before the motion that its publishers have sent.
  bool firstMessagesAreHere() const;
  void giveUpOnFirstMessages();

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_ROS_MOTION_SUBSCRIBER_H
