// Each stack's messages with its own names, types, frames, axes, rates and known mistakes, against
// the running node with that stack's preset: sign and size of speed, yaw rate and pitch rate.

#include <cmath>
#include <functional>
#include <memory>

#include <geometry_msgs/TwistStamped.h>
#include <geometry_msgs/Vector3Stamped.h>
#include <gtest/gtest.h>
#include <sensor_msgs/MagneticField.h>
#include <sensor_msgs/NavSatFix.h>
#include <tf2_msgs/TFMessage.h>
#include <Eigen/Geometry>

#include "adaptive_grid_stereo/GridState.h"
#include "support/node_probe.h"

namespace adaptive_grid_stereo {
namespace {

/// One steady manoeuvre of the aircraft.
struct Manoeuvre {
  double speed = 15.0;     // [m/s], along the forward axis
  double heading = 0.5;    // from east to the north [rad]
  double climb = 0.0;      // nose up [rad]
  double bank_left = 0.0;  // [rad]
  Eigen::Vector3d rate_flu = Eigen::Vector3d::Zero();

  Eigen::Quaterniond enuFromFlu() const {
    return Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitZ()) *
           Eigen::AngleAxisd(-climb, Eigen::Vector3d::UnitY()) *
           Eigen::AngleAxisd(-bank_left, Eigen::Vector3d::UnitX());
  }
  Eigen::Vector3d velocityEnu() const { return speed * (enuFromFlu() * Eigen::Vector3d::UnitX()); }
};

Eigen::Vector3d frd(const Eigen::Vector3d& flu) { return {flu.x(), -flu.y(), -flu.z()}; }
Eigen::Vector3d ned(const Eigen::Vector3d& enu) { return {enu.y(), enu.x(), -enu.z()}; }

/// The orientation of an FRD body against NED for that of an FLU body against ENU.
Eigen::Quaterniond nedFromFrd(const Eigen::Quaterniond& enu_from_flu) {
  Eigen::Matrix3d result;
  for (int i = 0; i < 3; ++i) result.col(i) = ned(enu_from_flu * frd(Eigen::Vector3d::Unit(i)));
  return Eigen::Quaterniond(result);
}

void set(const Eigen::Vector3d& from, geometry_msgs::Vector3* to) {
  to->x = from.x();
  to->y = from.y();
  to->z = from.z();
}
void set(const Eigen::Quaterniond& from, geometry_msgs::Quaternion* to) {
  to->w = from.w();
  to->x = from.x();
  to->y = from.y();
  to->z = from.z();
}

std_msgs::Header header(const ros::Time& stamp, const std::string& frame) {
  std_msgs::Header result;
  result.stamp = stamp;
  result.frame_id = frame;
  return result;
}

sensor_msgs::Imu imuMessage(const ros::Time& stamp, const std::string& frame,
                            const Eigen::Quaterniond& orientation, const Eigen::Vector3d& rate,
                            const Eigen::Vector3d& acceleration) {
  sensor_msgs::Imu message;
  message.header = header(stamp, frame);
  set(orientation, &message.orientation);
  set(rate, &message.angular_velocity);
  set(acceleration, &message.linear_acceleration);
  return message;
}

/// Specific force in a steady manoeuvre: gravity's and the turn's [FLU].
Eigen::Vector3d forceFlu(const Manoeuvre& m) {
  return m.enuFromFlu().conjugate() * Eigen::Vector3d(0, 0, 9.81) +
         m.rate_flu.cross(Eigen::Vector3d(m.speed, 0, 0));
}

sensor_msgs::NavSatFix fixMessage(const ros::Time& stamp, const Manoeuvre& m, double time) {
  sensor_msgs::NavSatFix message;
  message.header = header(stamp, "base_link");
  message.latitude = 47.0 + m.velocityEnu().y() * time / 111000.0;
  message.longitude = 8.0 + m.velocityEnu().x() * time / 76000.0;
  message.altitude = 500.0 + m.velocityEnu().z() * time;
  return message;
}

/// Publishes what a stack sends within one step of 20 ms; `step` counts them.
class Stack {
 public:
  virtual ~Stack() = default;
  virtual void publish(const Manoeuvre& m, const ros::Time& stamp, int step) = 0;
  virtual void publishImages(const ros::Time& stamp) = 0;
  virtual bool connected() const = 0;
  virtual std::string gridStateTopic() const { return "/stereo/grid_state"; }
};

class WithStereoTopics : public Stack {
 public:
  explicit WithStereoTopics(ros::NodeHandle& handle, double lateness)
      : cameras_(handle, "/stereo"), lateness_(lateness) {}
  void publishImages(const ros::Time& stamp) override {
    StereoPair pair = makePair(SyntheticRig(), 6, stamp);
    auto right = boost::make_shared<sensor_msgs::Image>(*pair.right);
    auto info = boost::make_shared<sensor_msgs::CameraInfo>(*pair.right_info);
    right->header.stamp = info->header.stamp = stamp + ros::Duration(lateness_);
    cameras_.left.publish(pair.left);
    cameras_.left_info.publish(pair.left_info);
    cameras_.right.publish(right);
    cameras_.right_info.publish(info);
  }
  bool connected() const override { return cameras_.imageSubscribers() > 0; }

 private:
  FakeAircraft cameras_;
  double lateness_;
};

class Mavros : public WithStereoTopics {
 public:
  Mavros(ros::NodeHandle& handle, bool odometry)
      : WithStereoTopics(handle, 0.0),
        imu_(handle.advertise<sensor_msgs::Imu>("/mavros/imu/data", 500)),
        odom_(handle.advertise<nav_msgs::Odometry>("/mavros/local_position/odom", 500)),
        wrong_(handle.advertise<nav_msgs::Odometry>("/mavros/global_position/local", 500)),
        velocity_(handle.advertise<geometry_msgs::TwistStamped>(
            "/mavros/global_position/raw/gps_vel", 500)),
        fix_(handle.advertise<sensor_msgs::NavSatFix>("/mavros/global_position/raw/fix", 500)),
        odometry_(odometry) {}

  bool connected() const override {
    return WithStereoTopics::connected() && imu_.getNumSubscribers() > 0 &&
           velocity_.getNumSubscribers() > 0 && fix_.getNumSubscribers() > 0 &&
           (!odometry_ || odom_.getNumSubscribers() > 0);
  }

  void publish(const Manoeuvre& m, const ros::Time& stamp, int step) override {
    imu_.publish(imuMessage(stamp, "base_link", m.enuFromFlu(), m.rate_flu, forceFlu(m)));
    nav_msgs::Odometry odom;
    odom.header = header(stamp, "map");
    odom.child_frame_id = "base_link";
    set(m.enuFromFlu(), &odom.pose.pose.orientation);
    set(Eigen::Vector3d(m.speed, 0, 0), &odom.twist.twist.linear);
    set(m.rate_flu, &odom.twist.twist.angular);
    if (odometry_ && step % 2 == 0) odom_.publish(odom);
    // Its linear twist is of the earth, with the vertical part upside down, its angular one zero.
    set(Eigen::Vector3d(m.velocityEnu().x(), m.velocityEnu().y(), -m.velocityEnu().z()),
        &odom.twist.twist.linear);
    set(Eigen::Vector3d::Zero(), &odom.twist.twist.angular);
    wrong_.publish(odom);
    if (step % 10 != 0) return;
    geometry_msgs::TwistStamped velocity;
    velocity.header = header(stamp, "map");
    set(m.velocityEnu(), &velocity.twist.linear);
    velocity.twist.linear.z = 0.0;  // never set
    velocity_.publish(velocity);
    fix_.publish(fixMessage(stamp, m, 0.02 * step));
  }

 private:
  ros::Publisher imu_, odom_, wrong_, velocity_, fix_;
  bool odometry_;
};

class Dji : public WithStereoTopics {
 public:
  explicit Dji(ros::NodeHandle& handle)
      : WithStereoTopics(handle, 0.004),
        imu_(handle.advertise<sensor_msgs::Imu>("/dji_osdk_ros/imu", 500)),
        velocity_(handle.advertise<geometry_msgs::Vector3Stamped>("/dji_osdk_ros/velocity", 500)),
        fix_(handle.advertise<sensor_msgs::NavSatFix>("/dji_osdk_ros/gps_position", 500)) {}
  bool connected() const override {
    return WithStereoTopics::connected() && imu_.getNumSubscribers() > 0 &&
           velocity_.getNumSubscribers() > 0;
  }
  void publish(const Manoeuvre& m, const ros::Time& stamp, int step) override {
    imu_.publish(imuMessage(stamp, "body_FLU", m.enuFromFlu(), m.rate_flu, forceFlu(m)));
    geometry_msgs::Vector3Stamped velocity;
    velocity.header = header(stamp, "ground_ENU");
    set(m.velocityEnu(), &velocity.vector);
    velocity_.publish(velocity);
    if (step % 5 == 0) fix_.publish(fixMessage(stamp, m, 0.02 * step));
  }

 private:
  ros::Publisher imu_, velocity_, fix_;
};

class AirSim : public Stack {
 public:
  explicit AirSim(ros::NodeHandle& handle)
      : imu_(handle.advertise<sensor_msgs::Imu>(kPrefix + "imu/Imu", 500)),
        odom_(handle.advertise<nav_msgs::Odometry>(kPrefix + "odom_local_ned", 500)),
        tf_(handle.advertise<tf2_msgs::TFMessage>("/tf", 500)),
        tf_static_(handle.advertise<tf2_msgs::TFMessage>("/tf_static", 5, true)) {
    for (const std::string side : {"front_left", "front_right"}) {
      images_.push_back(handle.advertise<sensor_msgs::Image>(kPrefix + side + "/Scene", 100));
      infos_.push_back(
          handle.advertise<sensor_msgs::CameraInfo>(kPrefix + side + "/Scene/camera_info", 100));
    }
    tf2_msgs::TFMessage message;
    message.transforms.resize(1);
    message.transforms[0].header = header(ros::Time(1.0), kBody);
    message.transforms[0].child_frame_id = "front_left_optical";
    Eigen::Matrix3d frd_from_optical;
    frd_from_optical << 0, 0, 1, 1, 0, 0, 0, 1, 0;
    set(Eigen::Quaterniond(frd_from_optical), &message.transforms[0].transform.rotation);
    tf_static_.publish(message);
  }

  std::string gridStateTopic() const override { return "/drone_1/grid_state"; }
  bool connected() const override {
    return images_[0].getNumSubscribers() > 0 && images_[1].getNumSubscribers() > 0 &&
           infos_[0].getNumSubscribers() > 0 && infos_[1].getNumSubscribers() > 0 &&
           imu_.getNumSubscribers() > 0 && odom_.getNumSubscribers() > 0 &&
           tf_.getNumSubscribers() > 0 && tf_static_.getNumSubscribers() > 0;
  }

  void publish(const Manoeuvre& m, const ros::Time& stamp, int) override {
    const Eigen::Quaterniond orientation = nedFromFrd(m.enuFromFlu());
    // The Imu's frame is that of the start, which does not turn with the vehicle.
    imu_.publish(imuMessage(stamp, "drone_1", orientation, frd(m.rate_flu), frd(forceFlu(m))));
    nav_msgs::Odometry odom;
    odom.header = header(stamp, "drone_1");
    odom.child_frame_id = kBody;
    set(orientation, &odom.pose.pose.orientation);
    set(ned(m.velocityEnu()), &odom.twist.twist.linear);
    set(frd(m.rate_flu), &odom.twist.twist.angular);
    odom_.publish(odom);
    tf2_msgs::TFMessage message;
    message.transforms.resize(1);
    message.transforms[0].header = header(stamp, "drone_1");
    message.transforms[0].child_frame_id = kBody;
    set(orientation, &message.transforms[0].transform.rotation);
    tf_.publish(message);
  }

  void publishImages(const ros::Time& stamp) override {
    StereoPair pair = makePair(SyntheticRig(), 6, stamp);
    const auto color = [](const sensor_msgs::Image& grey, const std_msgs::Header& header) {
      sensor_msgs::Image image;
      image.header = header;
      image.width = grey.width;
      image.height = grey.height;
      image.encoding = "bgr8";
      image.step = 3 * grey.width;
      for (std::uint32_t y = 0; y < grey.height; ++y) {
        for (std::uint32_t x = 0; x < grey.width; ++x) {
          image.data.insert(image.data.end(), 3, grey.data[y * grey.step + x]);
        }
      }
      return image;
    };
    const auto info = [](const std_msgs::Header& header) {
      sensor_msgs::CameraInfo result;  // no distortion model, no rotation, no baseline
      result.header = header;
      result.width = 128;
      result.height = 96;
      result.K = {100, 0, 64, 0, 100, 48, 0, 0, 1};
      result.P = {100, 0, 64, 0, 0, 100, 48, 0, 0, 0, 1, 0};
      return result;
    };
    const std_msgs::Header left = header(stamp, "front_left_optical");
    const std_msgs::Header right = header(stamp + ros::Duration(0.012), "front_right_optical");
    images_[0].publish(color(*pair.left, left));
    infos_[0].publish(info(left));
    images_[1].publish(color(*pair.right, right));
    infos_[1].publish(info(right));
  }

 private:
  const std::string kPrefix = "/airsim_node/drone_1/";
  const std::string kBody = "drone_1/odom_local_ned";
  ros::Publisher imu_, odom_, tf_, tf_static_;
  std::vector<ros::Publisher> images_, infos_;
};

class PresetTest : public testing::Test {
 protected:
  PresetTest() : spinner_(4) {
    ros::NodeHandle("~").getParam("stack", name_);
    if (name_ == "mavros") stack_ = std::make_unique<Mavros>(handle_, true);
    if (name_ == "mavros_gps_only") stack_ = std::make_unique<Mavros>(handle_, false);
    if (name_ == "dji") stack_ = std::make_unique<Dji>(handle_);
    if (name_ == "airsim") stack_ = std::make_unique<AirSim>(handle_);
    spinner_.start();
  }

  void fly(const Manoeuvre& manoeuvre, int number) {
    ASSERT_TRUE(stack_) << "unknown stack '" << name_ << "'";
    Listener<GridState> grid(handle_, stack_->gridStateTopic());
    ASSERT_TRUE(waitUntil([&] { return stack_->connected(); }));
    ASSERT_TRUE(grid.waitConnected());
    const ros::Time start(2000.0 + 10.0 * number);
    for (int step = 0; step <= 150; ++step) {
      stack_->publish(manoeuvre, start + ros::Duration(0.02 * step), step);
      ros::WallDuration(0.002).sleep();
    }
    ros::WallDuration(0.3).sleep();
    const ros::Time asked = start + ros::Duration(2.95);
    for (int i = 0; i < 4; ++i) stack_->publishImages(asked + ros::Duration(0.1 * i));
    state_ = grid.waitForStamp(asked);
    ASSERT_TRUE(state_) << "no grid_state from the node";
    EXPECT_TRUE(state_->motion_valid) << state_->motion_status;
    EXPECT_EQ(state_->rate_source, "imu");
    EXPECT_EQ(state_->speed_source, name_ == "mavros" || name_ == "airsim" ? "odom" : "gps_vel");
  }

  /// Without the vertical part of its velocity mavros loses a share of the speed in a climb.
  double expectedSpeed(const Manoeuvre& m) const {
    const double level = std::cos(m.climb);
    return name_ == "mavros_gps_only" ? m.speed * level * level : m.speed;
  }

  ros::NodeHandle handle_;
  ros::AsyncSpinner spinner_;
  std::string name_;
  std::unique_ptr<Stack> stack_;
  GridState::ConstPtr state_;
};

TEST_F(PresetTest, LeftTurn) {
  Manoeuvre turn;
  turn.rate_flu.z() = 0.4;
  fly(turn, 0);
  if (HasFatalFailure()) return;
  EXPECT_NEAR(state_->forward_speed, 15.0, 0.05);
  EXPECT_NEAR(state_->yaw_rate, 0.4, 0.01);
  EXPECT_NEAR(state_->pitch_rate, 0.0, 0.01);
  EXPECT_EQ(state_->state, GridState::FORWARD | GridState::YAW);
  EXPECT_EQ(state_->paths[3], 16) << "the left column";
  EXPECT_EQ(state_->paths[5], 4);
}

TEST_F(PresetTest, ClimbThatSteepens) {
  Manoeuvre climb;
  climb.climb = 0.3;
  climb.rate_flu.y() = -0.35;
  fly(climb, 1);
  if (HasFatalFailure()) return;
  EXPECT_NEAR(state_->forward_speed, expectedSpeed(climb), 0.05);
  EXPECT_NEAR(state_->yaw_rate, 0.0, 0.01);
  EXPECT_NEAR(state_->pitch_rate, 0.35, 0.01);
  EXPECT_EQ(state_->state, GridState::FORWARD | GridState::PITCH);
  EXPECT_EQ(state_->paths[1], 16) << "the upper row";
  EXPECT_EQ(state_->paths[7], 4);
}

TEST_F(PresetTest, BankedRightTurn) {
  Manoeuvre
      turn;  // 45 degrees of bank to the right: yaw right and pitch up for a camera on the body
  turn.bank_left = -M_PI / 4;
  turn.rate_flu = Eigen::Vector3d(0.0, -0.46, -0.46);
  fly(turn, 2);
  if (HasFatalFailure()) return;
  EXPECT_NEAR(state_->forward_speed, 15.0, 0.05);
  EXPECT_NEAR(state_->yaw_rate, -0.46, 0.01);
  EXPECT_NEAR(state_->pitch_rate, 0.46, 0.01);
  EXPECT_EQ(state_->state, GridState::FORWARD | GridState::YAW | GridState::PITCH);
  EXPECT_EQ(state_->paths[2], 16) << "the upper right cell";
}

}  // namespace
}  // namespace adaptive_grid_stereo

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "motion_presets_test");
  return RUN_ALL_TESTS();
}
