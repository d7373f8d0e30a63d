#include "motion_log.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "adaptive_grid_stereo/ros/parameter_visitor.h"
#include "command_line.h"

namespace adaptive_grid_stereo {

namespace {

/// Recorded time that passes before a stamp is asked for [s]: late samples have come by then.
constexpr double kPatience = 0.5;
/// Of a gap in the recording that is longer, only its end is asked for [s].
constexpr double kLongestGap = 60.0;

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
  // What is wanted, and what a simulator knows, is no sensor.
  if (contains(topic, "setpoint") || contains(topic, "ground_truth")) return -3;
  return 0;
}

namespace po = boost::program_options;

po::typed_value<double>* optionFor(double* target) {
  std::ostringstream text;
  text << *target;
  return po::value(target)->default_value(*target, text.str())->value_name("X");
}

po::typed_value<std::string>* optionFor(std::string* target) {
  return po::value(target)->default_value(*target)->value_name("NAME");
}

po::typed_value<std::string>* optionFor(VelocityAxes* target) {
  return po::value<std::string>()
      ->default_value(toString(*target))
      ->value_name("AXES")
      ->notifier([target](const std::string& name) { *target = velocityAxesFromString(name); });
}

po::typed_value<std::string>* optionFor(RateAxes* target) {
  return po::value<std::string>()
      ->default_value(toString(*target))
      ->value_name("AXES")
      ->notifier([target](const std::string& name) { *target = rateAxesFromString(name); });
}

po::typed_value<std::string>* optionFor(std::array<double, 3>* target) {
  return po::value<std::string>()->default_value("0,0,0")->value_name("R,P,Y")->notifier(
      [target](const std::string& text) {
        std::istringstream stream(text);
        char comma = ',', other = ',';
        if (!(stream >> (*target)[0] >> comma >> (*target)[1] >> other >> (*target)[2]) ||
            comma != ',' || other != ',' || !stream.eof()) {
          throw UsageError("--camera-rpy '" + text + "': expected roll,pitch,yaw in rad");
        }
      });
}

struct Candidate {
  std::string topic;
  std::size_t messages = 0;
};

/// Topics by datatype, with their numbers of messages.
std::multimap<std::string, Candidate> topicsByType(const BagReader& bag) {
  std::map<std::string, std::string> types;
  for (const BagConnection& connection : bag.connections()) {
    types[connection.topic] = connection.datatype;
  }
  std::multimap<std::string, Candidate> result;
  for (const auto& [topic, type] : types) {
    result.insert({type, {topic, bag.messageCount(topic)}});
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
bool give(const BagMessage& message, MotionSubscriber* subscriber) {
  subscriber->add(*deserialize<Message>(message));
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

boost::program_options::options_description motionOptions(MotionConfig* config) {
  boost::program_options::options_description options("motion parameters");
  visitMotionParameters(*config, [&](const char* parameter, auto& value) {
    options.add_options()(optionName(parameter).c_str(), optionFor(&value),
                          parameterHelp(parameter).c_str());
  });
  return options;
}

MotionTopics chooseMotionTopics(const BagReader& bag, MotionTopics topics) {
  const auto by_type = topicsByType(bag);
  choose(by_type, "sensor_msgs/Imu", &topics.imu);
  choose(by_type, "nav_msgs/Odometry", &topics.odom);
  choose(by_type, "geometry_msgs/TwistStamped", &topics.gps_vel);
  choose(by_type, "sensor_msgs/NavSatFix", &topics.gps_fix);
  choose(by_type, "sensor_msgs/MagneticField", &topics.mag);
  return topics;
}

bool feedMotion(const BagMessage& message, const MotionTopics& topics,
                MotionSubscriber* subscriber) {
  const std::string& topic = message.connection->topic;
  if (topic == topics.imu) return give<sensor_msgs::Imu>(message, subscriber);
  if (topic == topics.odom) return give<nav_msgs::Odometry>(message, subscriber);
  if (topic == topics.gps_vel) return give<geometry_msgs::TwistStamped>(message, subscriber);
  if (topic == topics.gps_fix) return give<sensor_msgs::NavSatFix>(message, subscriber);
  if (topic == topics.mag) return give<sensor_msgs::MagneticField>(message, subscriber);
  if (topic != "/tf" && topic != "/tf_static") return false;
  subscriber->add(*deserialize<tf2_msgs::TFMessage>(message), topic == "/tf_static");
  return true;
}

long replayMotion(BagReader* bag, const MotionReplay& replay, MotionSubscriber* subscriber,
                  const std::function<void(double stamp, const Motion& motion)>& answer) {
  if (bag->messageCount() == 0) return 0;
  const double step = 1.0 / replay.rate;
  double next = std::ceil(bag->beginTime().toSec() / step);
  const auto askUpTo = [&](double time) {
    // In a long gap the motion is unknown, and a damaged recording time may lie years ahead.
    if (time - next * step > kLongestGap) next = std::ceil((time - kLongestGap) / step);
    for (; next * step <= time; next += 1.0) {
      const ros::Time stamp(next * step);
      answer(next * step, subscriber->motionAt(stamp, replay.optical_frame));
    }
  };
  long damaged = 0;
  bag->rewind();
  for (BagMessage message; bag->next(&message);) {
    askUpTo(message.time.toSec() - kPatience);
    try {
      if (replay.before_message) replay.before_message(message);
      feedMotion(message, replay.topics, subscriber);
    } catch (const std::runtime_error&) {
      ++damaged;
    }
  }
  askUpTo(bag->endTime().toSec());
  return damaged;
}

}  // namespace adaptive_grid_stereo
