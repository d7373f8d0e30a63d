#include "motion_log.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include <rosbag/view.h>

namespace adaptive_grid_stereo {

namespace {

/// Recorded time that passes before a stamp is asked for [s]: late samples have come by then.
constexpr double kPatience = 0.5;

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// How much a topic is to be preferred among those of its type.
int preference(const std::string& topic) {
  if (contains(topic, "local_position/odom")) return 2;     // mavros: body axes throughout
  if (contains(topic, "global_position/local")) return -2;  // mavros: vertical sign is wrong
  if (contains(topic, "velocity_local")) return -2;         // mavros: frame is wrong
  if (contains(topic, "raw/gps_vel") || contains(topic, "raw/fix")) return 1;
  if (contains(topic, "data_raw") || contains(topic, "imu/raw")) return -1;  // no orientation
  if (contains(topic, "setpoint")) return -3;  // what is wanted, not what is
  return 0;
}

struct Candidate {
  std::string topic;
  std::uint32_t messages = 0;
};

/// Topics by datatype, with their numbers of messages.
std::multimap<std::string, Candidate> topicsByType(const rosbag::Bag& bag) {
  rosbag::View view(bag);
  std::map<std::string, std::string> types;
  for (const rosbag::ConnectionInfo* connection : view.getConnections()) {
    types[connection->topic] = connection->datatype;
  }
  std::multimap<std::string, Candidate> result;
  for (const auto& [topic, type] : types) {
    rosbag::View of_topic(bag, rosbag::TopicQuery(topic));
    result.insert({type, {topic, of_topic.size()}});
  }
  return result;
}

void choose(const std::multimap<std::string, Candidate>& topics, const std::string& type,
            std::string* topic) {
  if (*topic == "none") {
    topic->clear();
    return;
  }
  if (!topic->empty()) return;
  const auto [begin, end] = topics.equal_range(type);
  const auto best = std::max_element(begin, end, [](const auto& a, const auto& b) {
    const int left = preference(a.second.topic), right = preference(b.second.topic);
    return left != right ? left < right : a.second.messages < b.second.messages;
  });
  if (best != end && preference(best->second.topic) > -3) *topic = best->second.topic;
}

template <typename Message>
bool give(const rosbag::MessageInstance& instance, MotionSubscriber* subscriber) {
  const auto message = instance.instantiate<Message>();
  if (!message) return false;
  subscriber->add(*message);
  return true;
}

}  // namespace

boost::program_options::options_description motionTopicOptions(MotionTopics* topics) {
  namespace po = boost::program_options;
  po::options_description options("Topics (default: found by their types; 'none' leaves one out)");
  options.add_options()                                                             //
      ("imu-topic", po::value(&topics->imu), "sensor_msgs/Imu")                     //
      ("odom-topic", po::value(&topics->odom), "nav_msgs/Odometry")                 //
      ("gps-vel-topic", po::value(&topics->gps_vel), "geometry_msgs/TwistStamped")  //
      ("gps-fix-topic", po::value(&topics->gps_fix), "sensor_msgs/NavSatFix")       //
      ("mag-topic", po::value(&topics->mag), "sensor_msgs/MagneticField");
  return options;
}

MotionTopics chooseMotionTopics(const rosbag::Bag& bag, MotionTopics topics) {
  const auto by_type = topicsByType(bag);
  choose(by_type, "sensor_msgs/Imu", &topics.imu);
  choose(by_type, "nav_msgs/Odometry", &topics.odom);
  choose(by_type, "geometry_msgs/TwistStamped", &topics.gps_vel);
  choose(by_type, "sensor_msgs/NavSatFix", &topics.gps_fix);
  choose(by_type, "sensor_msgs/MagneticField", &topics.mag);
  return topics;
}

bool feedMotion(const rosbag::MessageInstance& message, const MotionTopics& topics,
                MotionSubscriber* subscriber) {
  const std::string& topic = message.getTopic();
  if (topic == topics.imu) return give<sensor_msgs::Imu>(message, subscriber);
  if (topic == topics.odom) return give<nav_msgs::Odometry>(message, subscriber);
  if (topic == topics.gps_vel) return give<geometry_msgs::TwistStamped>(message, subscriber);
  if (topic == topics.gps_fix) return give<sensor_msgs::NavSatFix>(message, subscriber);
  if (topic == topics.mag) return give<sensor_msgs::MagneticField>(message, subscriber);
  if (topic != "/tf" && topic != "/tf_static") return false;
  const auto transforms = message.instantiate<tf2_msgs::TFMessage>();
  if (transforms) subscriber->add(*transforms, topic == "/tf_static");
  return transforms != nullptr;
}

void replayMotion(const rosbag::Bag& bag, const MotionReplay& replay, MotionSubscriber* subscriber,
                  const std::function<void(double stamp, const Motion& motion)>& answer) {
  std::vector<std::string> wanted = {"/tf", "/tf_static"};
  const MotionTopics& topics = replay.topics;
  for (const std::string& topic :
       {topics.imu, topics.odom, topics.gps_vel, topics.gps_fix, topics.mag}) {
    if (!topic.empty()) wanted.push_back(topic);
  }
  rosbag::View view(bag, rosbag::TopicQuery(wanted));
  if (view.size() == 0) return;
  const double step = 1.0 / replay.rate;
  double next = std::ceil(view.getBeginTime().toSec() / step);
  const double end = view.getEndTime().toSec();
  const auto askUpTo = [&](double time) {
    for (; next * step <= time; next += 1.0) {
      const ros::Time stamp(next * step);
      answer(next * step, subscriber->motionAt(stamp, replay.optical_frame));
    }
  };
  for (const rosbag::MessageInstance& message : view) {
    askUpTo(message.getTime().toSec() - kPatience);
    if (replay.before_message) replay.before_message(message);
    feedMotion(message, topics, subscriber);
  }
  askUpTo(end);
}

}  // namespace adaptive_grid_stereo
