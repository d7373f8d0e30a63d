// Motion messages of any content, over the wire or with hostile fields: the motion stays finite,
// and its plan legal.

#include <cmath>

#include <console_bridge/console.h>
#include <ros/serialization.h>

#include "adaptive_grid_stereo/guidance/adaptive_grid.h"
#include "adaptive_grid_stereo/guidance/flight_state.h"
#include "adaptive_grid_stereo/ros/motion_subscriber.h"
#include "bag_reader.h"
#include "test/fuzz/fuzz_input.h"

namespace {

using namespace adaptive_grid_stereo;
using fuzz::FuzzInput;

ros::Time stampOf(FuzzInput* input) {
  if (input->between(0, 9) == 0) {
    return ros::Time{input->bits<std::uint32_t>(), input->bits<std::uint32_t>() % 1000000000U};
  }
  return ros::Time(1000, 0) + ros::Duration(input->between(0, 2000) * 1e-3);
}

void fill(FuzzInput* input, std_msgs::Header* header) {
  header->stamp = stampOf(input);
  header->frame_id = input->flag() ? "base_link" : input->text(12);
}
template <typename Vector>
void fillVector(FuzzInput* input, Vector* v) {
  v->x = input->number();
  v->y = input->number();
  v->z = input->number();
}
void fillRotation(FuzzInput* input, geometry_msgs::Quaternion* q) {
  fillVector(input, q);
  q->w = input->number();
  if (input->flag()) {  // a legal one
    q->x = q->y = 0.0;
    q->z = std::sin(0.5);
    q->w = std::cos(0.5);
  }
}

void fill(FuzzInput* input, sensor_msgs::Imu* m) {
  fill(input, &m->header);
  fillVector(input, &m->angular_velocity);
  fillVector(input, &m->linear_acceleration);
  fillRotation(input, &m->orientation);
  m->orientation_covariance[0] = input->flag() ? -1.0 : input->number();
}
void fill(FuzzInput* input, nav_msgs::Odometry* m) {
  fill(input, &m->header);
  m->child_frame_id = input->flag() ? "base_link" : input->text(12);
  fillVector(input, &m->twist.twist.linear);
  fillVector(input, &m->twist.twist.angular);
  fillRotation(input, &m->pose.pose.orientation);
}
void fill(FuzzInput* input, geometry_msgs::TwistStamped* m) {
  fill(input, &m->header);
  fillVector(input, &m->twist.linear);
}
void fill(FuzzInput* input, sensor_msgs::NavSatFix* m) {
  fill(input, &m->header);
  m->latitude = input->number();
  m->longitude = input->number();
  m->altitude = input->number();
  m->status.status = static_cast<std::int8_t>(input->between(-2, 2));
}
void fill(FuzzInput* input, sensor_msgs::MagneticField* m) {
  fill(input, &m->header);
  fillVector(input, &m->magnetic_field);
}
void fill(FuzzInput* input, tf2_msgs::TFMessage* m) {
  m->transforms.resize(static_cast<std::size_t>(input->between(0, 2)));
  for (geometry_msgs::TransformStamped& transform : m->transforms) {
    fill(input, &transform.header);
    transform.child_frame_id = input->flag() ? "left_optical" : input->text(12);
    fillVector(input, &transform.transform.translation);
    fillRotation(input, &transform.transform.rotation);
  }
}

/// A message from its fields, or from serialised bytes; false if roscpp would drop it.
template <typename Message>
bool next(FuzzInput* input, Message* message) {
  if (input->flag()) {
    fill(input, message);
    return true;
  }
  const std::size_t size = std::min<std::size_t>(input->bits<std::uint16_t>(), input->left());
  std::vector<std::uint8_t> bytes(size);
  for (std::uint8_t& byte : bytes) byte = input->bits<std::uint8_t>();
  try {
    // roscpp itself takes as much memory as the message claims to need.
    checkArrayLengths(ros::message_traits::datatype<Message>(), bytes.data(),
                      static_cast<std::uint32_t>(bytes.size()));
    ros::serialization::IStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
    ros::serialization::deserialize(stream, *message);
    return true;
  } catch (const std::exception&) {
    return false;
  }
}

template <typename Message>
void add(FuzzInput* input, MotionSubscriber* subscriber) {
  Message message;
  if (next(input, &message)) subscriber->add(message);
}

MotionConfig configOf(FuzzInput* input) {
  constexpr const char* kSpeed[] = {"auto", "odom", "gps_vel", "gps_fix"};
  constexpr const char* kRates[] = {"auto", "imu", "odom"};
  MotionConfig config;
  config.speed_source = kSpeed[input->between(0, 3)];
  config.rate_source = kRates[input->between(0, 2)];
  config.velocity_axes = static_cast<VelocityAxes>(input->between(0, 3));
  config.rate_axes = static_cast<RateAxes>(input->between(0, 1));
  config.tf_axes = static_cast<RateAxes>(input->between(0, 1));
  config.camera_rpy = {input->near(0.0), input->near(0.1), input->near(0.0)};
  config.motion_delay = input->near(0.0);
  config.motion_timeout = input->near(0.5);
  config.rate_filter_time = input->near(0.1);
  config.fix_window = input->near(2.0);
  config.magnetic_declination = input->near(0.0);
  config.validate();
  return config;
}

void ask(FuzzInput* input, MotionSubscriber* subscriber, FlightStateMachine* machine) {
  const ros::Time stamp = stampOf(input);
  const std::string frame = input->flag() ? "left_optical" : "";
  subscriber->ready(stamp, frame);
  const Motion motion = subscriber->motionAt(stamp, frame);
  fuzz::require(std::isfinite(motion.forward_speed) && std::isfinite(motion.yaw_rate) &&
                    std::isfinite(motion.pitch_rate),
                "a motion that is no number");
  fuzz::require(motion.valid == motion.reason.empty(), "an invalid motion without a reason");
  const GuidanceConfig guidance;
  const FlightState state = machine->update(motion, stamp.toSec(), guidance);
  checkPlan(makePathPlan(state, motion.forward_speed, guidance, 640, 480), 640, 480);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  console_bridge::noOutputHandler();
  ros::Time::init();
  FuzzInput input(data, size);
  MotionSubscriber subscriber(configOf(&input));
  FlightStateMachine machine;
  for (int steps = 0; input.left() > 0 && steps < 200; ++steps) {
    switch (input.between(0, 9)) {
      case 0:
        add<sensor_msgs::Imu>(&input, &subscriber);
        break;
      case 1:
        add<nav_msgs::Odometry>(&input, &subscriber);
        break;
      case 2:
        add<geometry_msgs::TwistStamped>(&input, &subscriber);
        break;
      case 3:
        add<sensor_msgs::NavSatFix>(&input, &subscriber);
        break;
      case 4:
        add<sensor_msgs::MagneticField>(&input, &subscriber);
        break;
      case 5: {
        tf2_msgs::TFMessage message;
        if (next(&input, &message)) subscriber.add(message, input.flag());
        break;
      }
      case 6:
        subscriber.setConfig(configOf(&input));
        break;
      case 7:
        subscriber.startOver(ros::Time(input.bits<std::uint32_t>(), 0));
        break;
      default:
        ask(&input, &subscriber, &machine);
    }
  }
  ask(&input, &subscriber, &machine);
  subscriber.status();
  return 0;
}
