#include "motion_log.h"

#include <cmath>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "adaptive_grid_stereo/ros/parameter_visitor.h"
#include "command_line.h"
#include "yaml_parameters.h"

namespace adaptive_grid_stereo {

namespace {

/// Recorded time that passes before a stamp is asked for [s]: late samples have come by then.
constexpr double kPatience = 0.5;
/// Of a gap in the recording that is longer, only its end is asked for [s].
constexpr double kLongestGap = 60.0;

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
        XmlRpc::XmlRpcValue list = parseParameterOption("camera_rpy", text);
        for (int i = 0; i < 3; ++i) {
          (*target)[static_cast<std::size_t>(i)] =
              list[i].getType() == XmlRpc::XmlRpcValue::TypeInt
                  ? static_cast<double>(static_cast<int>(list[i]))
                  : static_cast<double>(list[i]);
        }
      });
}

template <typename Message>
bool give(const BagMessage& message, MotionSubscriber* subscriber) {
  subscriber->add(*deserialize<Message>(message));
  return true;
}

}  // namespace

boost::program_options::options_description motionOptions(MotionConfig* config) {
  boost::program_options::options_description options("motion parameters");
  visitMotionParameters(*config, [&](const char* parameter, auto& value) {
    options.add_options()(optionName(parameter).c_str(), optionFor(&value),
                          parameterHelp(parameter).c_str());
  });
  return options;
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

namespace {

/// Recordings whose messages were stamped so much earlier are copies, made while an older one was
/// played [s].
constexpr double kCopied = 60.0;

/// How much later than its stamp the first motion message was recorded [s], if it was recorded
/// again, else 0; nothing while none has come.
std::optional<double> recordingDelay(const ros::Time& recorded, const MotionInputStatus& status) {
  for (const MotionSourceStatus& source : status.sources) {
    if (source.last_stamp <= 0.0) continue;
    const double delay = recorded.toSec() - source.last_stamp;
    return std::abs(delay) > kCopied ? delay : 0.0;
  }
  return std::nullopt;
}

}  // namespace

long replayMotion(BagReader* bag, const MotionReplay& replay, MotionSubscriber* subscriber,
                  const std::function<void(double stamp, const Motion& motion)>& answer) {
  if (bag->messageCount() == 0) return 0;
  const double step = 1.0 / replay.rate;
  double next = std::ceil(bag->beginTime().toSec() / step);
  std::optional<double> delay;
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
    askUpTo(message.time.toSec() - delay.value_or(0.0) - kPatience);
    try {
      if (replay.before_message) replay.before_message(message);
      const bool fed = feedMotion(message, replay.topics, subscriber);
      if (fed && !delay) {
        delay = recordingDelay(message.time, subscriber->status());
        if (delay.value_or(0.0) != 0.0) next = std::ceil((message.time.toSec() - *delay) / step);
      }
    } catch (const std::runtime_error&) {
      ++damaged;
    }
  }
  askUpTo(bag->endTime().toSec() - delay.value_or(0.0));
  return damaged;
}

}  // namespace adaptive_grid_stereo
