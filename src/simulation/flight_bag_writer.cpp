#include "adaptive_grid_stereo/simulation/flight_bag_writer.h"

#include <cmath>
#include <cstring>

#include <geometry_msgs/TransformStamped.h>
#include <geometry_msgs/TwistStamped.h>
#include <nav_msgs/Odometry.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/MagneticField.h>
#include <sensor_msgs/NavSatFix.h>
#include <sensor_msgs/image_encodings.h>
#include <stereo_msgs/DisparityImage.h>
#include <tf2_msgs/TFMessage.h>

namespace adaptive_grid_stereo {
namespace simulation {
namespace {

constexpr char kWorldFrame[] = "map";
constexpr char kBodyFrame[] = "base_link";
constexpr char kLeftFrame[] = "stereo_left_optical";
constexpr char kRightFrame[] = "stereo_right_optical";

// Images arrive so long after their stamp, so that the motion of the same instant comes before them
// in the bag, too: players order messages by their time of arrival alone.
const ros::Duration kReadout(0.001);

template <typename Vector>
void copyVector(const Eigen::Vector3d& from, Vector* to) {
  to->x = from.x();
  to->y = from.y();
  to->z = from.z();
}

void copyRotation(const Eigen::Quaterniond& from, geometry_msgs::Quaternion* to) {
  to->w = from.w();
  to->x = from.x();
  to->y = from.y();
  to->z = from.z();
}

// Variances on the diagonal of an N x N covariance, three from entry `first` on.
template <typename Covariance>
void setDiagonal(double deviation, int first, int size, Covariance* covariance) {
  for (int i = first; i < first + 3; ++i) (*covariance)[i * size + i] = deviation * deviation;
}

geometry_msgs::TransformStamped makeTransform(const std::string& parent, const std::string& child,
                                              const ros::Time& stamp,
                                              const Eigen::Vector3d& translation,
                                              const Eigen::Quaterniond& rotation) {
  geometry_msgs::TransformStamped transform;
  transform.header.stamp = stamp;
  transform.header.frame_id = parent;
  transform.child_frame_id = child;
  copyVector(translation, &transform.transform.translation);
  copyRotation(rotation, &transform.transform.rotation);
  return transform;
}

nav_msgs::Odometry makeOdometry(const OdometryReading& reading, const ros::Time& stamp,
                                const SensorConfig& noise) {
  nav_msgs::Odometry message;
  message.header.stamp = stamp;
  message.header.frame_id = kWorldFrame;
  message.child_frame_id = kBodyFrame;
  copyVector(reading.position, &message.pose.pose.position);
  copyRotation(reading.attitude, &message.pose.pose.orientation);
  copyVector(reading.velocity, &message.twist.twist.linear);
  copyVector(reading.angular_rate, &message.twist.twist.angular);
  setDiagonal(noise.noise_scale * noise.position_wander, 0, 6, &message.pose.covariance);
  setDiagonal(noise.noise_scale * noise.attitude_wander, 3, 6, &message.pose.covariance);
  setDiagonal(noise.noise_scale * noise.velocity_noise, 0, 6, &message.twist.covariance);
  setDiagonal(noise.noise_scale * noise.gyro_noise, 3, 6, &message.twist.covariance);
  return message;
}

sensor_msgs::Image makeImage(const cv::Mat& pixels, const std::string& encoding,
                             const std::string& frame, const ros::Time& stamp) {
  sensor_msgs::Image message;
  message.header.stamp = stamp;
  message.header.frame_id = frame;
  message.height = static_cast<std::uint32_t>(pixels.rows);
  message.width = static_cast<std::uint32_t>(pixels.cols);
  message.encoding = encoding;
  message.step = static_cast<std::uint32_t>(pixels.cols * pixels.elemSize());
  message.data.resize(static_cast<std::size_t>(message.step) * message.height);
  for (int row = 0; row < pixels.rows; ++row) {
    std::memcpy(&message.data[static_cast<std::size_t>(row) * message.step], pixels.ptr(row),
                message.step);
  }
  return message;
}

}  // namespace

sensor_msgs::CameraInfo makeCameraInfo(const StereoRig& rig, bool right) {
  sensor_msgs::CameraInfo info;
  info.header.frame_id = right ? kRightFrame : kLeftFrame;
  info.width = static_cast<std::uint32_t>(rig.width);
  info.height = static_cast<std::uint32_t>(rig.height);
  info.distortion_model = "plumb_bob";
  info.D.assign(5, 0.0);
  info.K = {rig.focal, 0, rig.cx(), 0, rig.focal, rig.cy(), 0, 0, 1};
  info.R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.P = {rig.focal, 0,         rig.cx(), right ? -rig.focal * rig.baseline : 0.0,
            0,         rig.focal, rig.cy(), 0,
            0,         0,         1,        0};
  return info;
}

FlightBagWriter::FlightBagWriter(const std::string& path, const FlightBagConfig& config)
    : config_(config), bag_(path, rosbag::bagmode::Write) {
  latched_ = boost::make_shared<ros::M_string>();
  using Type = tf2_msgs::TFMessage;
  (*latched_)["topic"] = "/tf_static";
  (*latched_)["type"] = ros::message_traits::DataType<Type>::value();
  (*latched_)["md5sum"] = ros::message_traits::MD5Sum<Type>::value();
  (*latched_)["message_definition"] = ros::message_traits::Definition<Type>::value();
  (*latched_)["callerid"] = "/simulate_flight";
  (*latched_)["latching"] = "1";
}

long FlightBagWriter::frameCount(double duration, double image_rate) {
  return static_cast<long>(std::ceil(duration * image_rate - 1e-9));
}

ros::Time FlightBagWriter::stampAt(double time) const {
  // Whole nanoseconds apart from a whole start: the same stamp for the same time in every message.
  ros::Time stamp(config_.start_time);
  return stamp + ros::Duration().fromNSec(std::llround(time * 1e9));
}

template <typename Message>
void FlightBagWriter::put(const std::string& topic, const ros::Time& arrival,
                          const Message& message) {
  bag_.write(topic, arrival, message);
}

void FlightBagWriter::writeStaticTransforms() {
  const ros::Time stamp = stampAt(0.0);
  tf2_msgs::TFMessage message;
  const Eigen::Quaterniond rotation = StereoRig::bodyFromOptical();
  message.transforms = {
      makeTransform(kBodyFrame, kLeftFrame, stamp, config_.rig.leftPosition(), rotation),
      makeTransform(kBodyFrame, kRightFrame, stamp, config_.rig.rightPosition(), rotation)};
  bag_.write("/tf_static", stamp, message, latched_);
}

void FlightBagWriter::writeImu(const FlightSample& truth, const Sensors& sensors,
                               std::uint64_t index) {
  const ImuReading reading = sensors.imu(truth, index);
  const SensorConfig& noise = sensors.config();
  sensor_msgs::Imu message;
  message.header.stamp = stampAt(truth.time);
  message.header.frame_id = kBodyFrame;
  copyRotation(reading.attitude, &message.orientation);
  copyVector(reading.angular_rate, &message.angular_velocity);
  copyVector(reading.specific_force, &message.linear_acceleration);
  setDiagonal(noise.noise_scale * noise.attitude_wander, 0, 3, &message.orientation_covariance);
  setDiagonal(noise.noise_scale * noise.gyro_noise, 0, 3, &message.angular_velocity_covariance);
  setDiagonal(noise.noise_scale * noise.accelerometer_noise, 0, 3,
              &message.linear_acceleration_covariance);
  put("/imu", message.header.stamp, message);
}

void FlightBagWriter::writeOdometry(const FlightSample& truth, const Sensors& sensors,
                                    std::uint64_t index) {
  const ros::Time stamp = stampAt(truth.time);
  put("/odom", stamp, makeOdometry(sensors.odometry(truth, index), stamp, sensors.config()));
  tf2_msgs::TFMessage transforms;
  transforms.transforms = {
      makeTransform(kWorldFrame, kBodyFrame, stamp, truth.position, truth.attitude)};
  put("/tf", stamp, transforms);
  if (config_.write_truth) {
    SensorConfig perfect;
    perfect.noise_scale = 0.0;
    put("/ground_truth/odom", stamp,
        makeOdometry(Sensors(perfect).odometry(truth, index), stamp, perfect));
  }
}

void FlightBagWriter::writeGps(const FlightSample& truth, const Sensors& sensors,
                               std::uint64_t index) {
  const GeodeticPosition reading = sensors.gpsPosition(truth, index);
  const SensorConfig& noise = sensors.config();
  sensor_msgs::NavSatFix fix;
  fix.header.stamp = stampAt(truth.time);
  fix.header.frame_id = "gps";
  fix.status.status = sensor_msgs::NavSatStatus::STATUS_FIX;
  fix.status.service = sensor_msgs::NavSatStatus::SERVICE_GPS;
  fix.latitude = reading.latitude;
  fix.longitude = reading.longitude;
  fix.altitude = reading.altitude;
  const double horizontal = noise.noise_scale * noise.gps_position_wander;
  fix.position_covariance = {horizontal * horizontal,    0, 0, 0, horizontal * horizontal, 0, 0, 0,
                             4 * horizontal * horizontal};
  fix.position_covariance_type = sensor_msgs::NavSatFix::COVARIANCE_TYPE_DIAGONAL_KNOWN;
  put("/gps/fix", fix.header.stamp, fix);

  geometry_msgs::TwistStamped velocity;
  velocity.header.stamp = fix.header.stamp;
  velocity.header.frame_id = kWorldFrame;
  copyVector(sensors.gpsVelocity(truth, index), &velocity.twist.linear);
  put("/gps/vel", velocity.header.stamp, velocity);
}

void FlightBagWriter::writeMagneticField(const FlightSample& truth, const Sensors& sensors,
                                         std::uint64_t index) {
  sensor_msgs::MagneticField message;
  message.header.stamp = stampAt(truth.time);
  message.header.frame_id = kBodyFrame;
  copyVector(sensors.magneticField(truth, index), &message.magnetic_field);
  setDiagonal(sensors.config().noise_scale * sensors.config().magnetic_noise, 0, 3,
              &message.magnetic_field_covariance);
  put("/mag", message.header.stamp, message);
}

void FlightBagWriter::writeSensors(const Trajectory& flight, const Sensors& sensors,
                                   std::int64_t tick) {
  const FlightSample truth = flight.at(static_cast<double>(tick) / config_.imu_rate);
  writeImu(truth, sensors, static_cast<std::uint64_t>(tick));
  const auto isDue = [&](int rate) { return tick % (config_.imu_rate / rate) == 0; };
  const auto indexOf = [&](int rate) {
    return static_cast<std::uint64_t>(tick / (config_.imu_rate / rate));
  };
  if (isDue(config_.odometry_rate)) writeOdometry(truth, sensors, indexOf(config_.odometry_rate));
  if (isDue(config_.magnetic_rate)) {
    writeMagneticField(truth, sensors, indexOf(config_.magnetic_rate));
  }
  if (isDue(config_.gps_rate)) writeGps(truth, sensors, indexOf(config_.gps_rate));
}

void FlightBagWriter::writeTruth(const StereoFrame& frame, const ros::Time& stamp) {
  stereo_msgs::DisparityImage truth;
  truth.image =
      makeImage(frame.disparity, sensor_msgs::image_encodings::TYPE_32FC1, kLeftFrame, stamp);
  truth.header = truth.image.header;
  truth.f = static_cast<float>(config_.rig.focal);
  truth.T = static_cast<float>(config_.rig.baseline);
  truth.valid_window.width = truth.image.width;
  truth.valid_window.height = truth.image.height;
  truth.min_disparity = 0.0f;
  float largest = 1.0f;  // never 0: disparity_view refuses an empty range
  for (int row = 0; row < frame.disparity.rows; ++row) {
    const auto* values = frame.disparity.ptr<float>(row);
    for (int column = 0; column < frame.disparity.cols; ++column) {
      largest = std::max(largest, values[column]);
    }
  }
  truth.max_disparity = std::ceil(largest);
  truth.delta_d = 1e-4f;
  put("/ground_truth/disparity", stamp + kReadout, truth);
  put("/ground_truth/occlusion", stamp + kReadout,
      makeImage(frame.occlusion, sensor_msgs::image_encodings::MONO8, kLeftFrame, stamp));
}

void FlightBagWriter::writeFrame(const StereoFrame& frame, double time) {
  const ros::Time stamp = stampAt(time);
  for (const bool right : {false, true}) {
    const std::string side = right ? "/stereo/right/" : "/stereo/left/";
    sensor_msgs::CameraInfo info = makeCameraInfo(config_.rig, right);
    info.header.stamp = stamp;
    put(side + "image_rect", stamp + kReadout,
        makeImage(right ? frame.right : frame.left, sensor_msgs::image_encodings::MONO8,
                  info.header.frame_id, stamp));
    put(side + "camera_info", stamp + kReadout, info);
  }
  if (config_.write_truth) writeTruth(frame, stamp);
}

void FlightBagWriter::write(const Trajectory& flight, const Sensors& sensors,
                            const Renderer& renderer, const Progress& progress) {
  writeStaticTransforms();
  const long frames = frameCount(flight.duration(), config_.image_rate);
  const auto last_tick = static_cast<std::int64_t>(flight.duration() * config_.imu_rate);
  std::int64_t tick = 0;
  for (long index = 0; index < frames; ++index) {
    const double time = static_cast<double>(index) / config_.image_rate;
    // Motion comes first, up to the frame's own stamp.
    while (tick <= last_tick && static_cast<double>(tick) / config_.imu_rate <= time + 1e-9) {
      writeSensors(flight, sensors, tick++);
    }
    writeFrame(renderer.render(flight, time, static_cast<std::uint64_t>(index)), time);
    if (progress) progress(index + 1);
  }
  while (tick <= last_tick) writeSensors(flight, sensors, tick++);
  bag_.close();
}

}  // namespace simulation
}  // namespace adaptive_grid_stereo
