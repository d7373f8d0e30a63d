#ifndef ADAPTIVE_GRID_STEREO_TOOLS_MOTION_LOG_H
#define ADAPTIVE_GRID_STEREO_TOOLS_MOTION_LOG_H

#include <functional>
#include <string>

#include <rosbag/bag.h>
#include <rosbag/message_instance.h>
#include <boost/program_options.hpp>

#include "adaptive_grid_stereo/guidance/motion.h"
#include "adaptive_grid_stereo/ros/motion_subscriber.h"
#include "bag_reader.h"
#include "bag_topics.h"

namespace adaptive_grid_stereo {

/// One option per parameter of the motion estimate, as matcherOptions() has them for the matcher;
/// --camera-rpy takes "roll,pitch,yaw", with or without brackets.
boost::program_options::options_description motionOptions(MotionConfig* config);

/// Gives a message to the subscriber if it stands on one of the topics, or on /tf or /tf_static.
/// Returns whether it did. Throws std::runtime_error if the message is damaged.
bool feedMotion(const BagMessage& message, const MotionTopics& topics,
                MotionSubscriber* subscriber);

/// How a log is gone through.
struct MotionReplay {
  MotionTopics topics;
  std::string optical_frame;  // of the left camera; empty: the mounting is camera_rpy
  double rate = 25.0;         // questions per second
  /// Called for each message before it is used; may be empty.
  std::function<void(const BagMessage&)> before_message;
};

/// Plays a bag's motion into the subscriber and asks it `rate` times a second (at multiples of
/// 1/rate), as a live node would for images with such stamps. Where the recording is a copy of an
/// older one, whose messages have kept their stamps, the questions follow those stamps. Returns the
/// number of damaged messages, which are left out.
long replayMotion(BagReader* bag, const MotionReplay& replay, MotionSubscriber* subscriber,
                  const std::function<void(double stamp, const Motion& motion)>& answer);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_TOOLS_MOTION_LOG_H
