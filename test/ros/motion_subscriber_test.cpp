// From messages to motion without a master: what is refused and why, TF, faults, recovery.
#include "adaptive_grid_stereo/ros/motion_subscriber.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace adaptive_grid_stereo {
namespace {

sensor_msgs::Imu imu(double stamp, double yaw_rate = 0.3) {
  sensor_msgs::Imu message;
  message.header.stamp = ros::Time(stamp);
  message.header.frame_id = "base_link";
  message.orientation.w = 1.0;
  message.angular_velocity.z = yaw_rate;
  message.linear_acceleration.z = 9.81;
  return message;
}

nav_msgs::Odometry odom(double stamp, double speed = 12.0) {
  nav_msgs::Odometry message;
  message.header.stamp = ros::Time(stamp);
  message.child_frame_id = "base_link";
  message.pose.pose.orientation.w = 1.0;
  message.twist.twist.linear.x = speed;
  return message;
}

/// A camera on base_link (FLU) that is rolled to the right by `roll` [rad].
tf2_msgs::TFMessage mounting(double stamp, double roll, const std::string& parent = "base_link") {
  const double s = std::sin(roll / 2), c = std::cos(roll / 2);
  tf2_msgs::TFMessage message;
  message.transforms.resize(1);
  message.transforms[0].header.stamp = ros::Time(stamp);
  message.transforms[0].header.frame_id = parent;
  message.transforms[0].child_frame_id = "optical";
  // The roll (c + s i) times the optical axes (0.5 - 0.5 i + 0.5 j - 0.5 k).
  geometry_msgs::Quaternion& q = message.transforms[0].transform.rotation;
  q.w = 0.5 * c + 0.5 * s;
  q.x = -0.5 * c + 0.5 * s;
  q.y = 0.5 * c + 0.5 * s;
  q.z = -0.5 * c + 0.5 * s;
  return message;
}

const MotionSourceStatus& statusOf(const MotionInputStatus& status, const std::string& name) {
  for (const MotionSourceStatus& source : status.sources) {
    if (source.name == name) return source;
  }
  throw std::runtime_error("no source " + name);
}

class MotionSubscriberTest : public testing::Test {
 protected:
  void fly(double from, double to) {
    for (int i = 0; from + 0.01 * i <= to + 1e-9; ++i) {
      subscriber_.add(imu(from + 0.01 * i));
      if (i % 2 == 0) subscriber_.add(odom(from + 0.01 * i));
    }
  }
  Motion at(double stamp, const std::string& frame = "") {
    return subscriber_.motionAt(ros::Time(stamp), frame);
  }
  MotionSubscriber subscriber_{MotionConfig()};
};

TEST_F(MotionSubscriberTest, MessagesBecomeMotion) {
  fly(10.0, 12.0);
  const Motion motion = at(11.5);
  ASSERT_TRUE(motion.valid) << motion.reason;
  EXPECT_NEAR(motion.forward_speed, 12.0, 1e-6);
  EXPECT_NEAR(motion.yaw_rate, 0.3, 1e-6);
  EXPECT_EQ(motion.speed_source, "odom");
  EXPECT_EQ(motion.rate_source, "imu");
  EXPECT_TRUE(motion.has_history);
  EXPECT_EQ(subscriber_.status().mounting, "camera_rpy");
  EXPECT_NEAR(statusOf(subscriber_.status(), "imu").rate, 100.0, 0.1);
}

TEST_F(MotionSubscriberTest, RefusesWithASentence) {
  sensor_msgs::Imu bad_imu = imu(10.0);
  bad_imu.angular_velocity.x = std::nan("");
  subscriber_.add(bad_imu);
  nav_msgs::Odometry unstamped = odom(10.0);
  unstamped.header.stamp = ros::Time();
  subscriber_.add(unstamped);
  geometry_msgs::TwistStamped velocity;
  velocity.header.stamp = ros::Time(10.0);
  velocity.twist.linear.y = std::numeric_limits<double>::infinity();
  subscriber_.add(velocity);
  sensor_msgs::NavSatFix no_fix;
  no_fix.header.stamp = ros::Time(10.0);
  no_fix.status.status = sensor_msgs::NavSatStatus::STATUS_NO_FIX;
  subscriber_.add(no_fix);
  sensor_msgs::MagneticField field;
  field.header.stamp = ros::Time(10.0);
  field.magnetic_field.z = std::nan("");
  subscriber_.add(field);

  const MotionInputStatus status = subscriber_.status();
  const std::pair<const char*, const char*> expected[] = {{"imu", "angular_velocity"},
                                                          {"odom", "header.stamp is zero"},
                                                          {"gps_vel", "twist.linear"},
                                                          {"gps_fix", "STATUS_FIX"},
                                                          {"mag", "magnetic_field"}};
  for (const auto& [name, words] : expected) {
    const MotionSourceStatus& source = statusOf(status, name);
    EXPECT_EQ(source.received, 1u) << name;
    EXPECT_EQ(source.invalid, 1u) << name;
    EXPECT_NE(source.last_error.find(words), std::string::npos) << source.last_error;
  }
  EXPECT_FALSE(at(10.0).valid);
}

TEST_F(MotionSubscriberTest, OrientationCountsOnlyWhereThereIsOne) {
  const auto speedWith = [](const sensor_msgs::Imu& prototype) {
    MotionConfig config;
    config.velocity_axes = VelocityAxes::kEnu;
    MotionSubscriber subscriber(config);
    for (int i = 0; i <= 100; ++i) {
      sensor_msgs::Imu message = prototype;
      message.header.stamp = ros::Time(10.0 + 0.01 * i);
      subscriber.add(message);
      geometry_msgs::TwistStamped velocity;
      velocity.header.stamp = message.header.stamp;
      velocity.twist.linear.y = 8.0;  // north, while the body looks north-east
      subscriber.add(velocity);
    }
    return subscriber.motionAt(ros::Time(11.0), "").forward_speed;
  };
  sensor_msgs::Imu message = imu(10.0, 0.0);
  message.orientation.w = std::cos(M_PI / 8);
  message.orientation.z = std::sin(M_PI / 8);
  EXPECT_NEAR(speedWith(message), 8.0 * std::sin(M_PI / 4), 1e-6);
  message.orientation_covariance[0] = -1.0;
  EXPECT_NEAR(speedWith(message), 8.0, 1e-6) << "the ground speed";
  message.orientation_covariance[0] = 0.0;
  message.orientation.w = message.orientation.z = 0.0;
  EXPECT_NEAR(speedWith(message), 8.0, 1e-6) << "a quaternion of zeros is none";
  message.orientation.w = std::nan("");
  EXPECT_NEAR(speedWith(message), 8.0, 1e-6);
}

TEST_F(MotionSubscriberTest, TransformsTurnTheRates) {
  fly(10.0, 12.0);
  subscriber_.add(mounting(1.0, 0.0), true);
  Motion motion = at(11.5, "optical");
  EXPECT_EQ(subscriber_.status().mounting, "tf");
  EXPECT_NEAR(motion.yaw_rate, 0.3, 1e-6);
  EXPECT_NEAR(motion.pitch_rate, 0.0, 1e-6);
  // A camera rolled right by 90 degrees has the body's right above: a turn to the left is
  // downwards.
  subscriber_.add(mounting(1.0, M_PI / 2, "/base_link"), true);
  motion = at(11.6, "/optical");
  EXPECT_NEAR(motion.yaw_rate, 0.0, 1e-6);
  EXPECT_NEAR(motion.pitch_rate, -0.3, 1e-6);
  EXPECT_EQ(at(11.7, "another_camera").valid, true);
  EXPECT_EQ(subscriber_.status().mounting, "camera_rpy");
}

TEST_F(MotionSubscriberTest, SilentGimbalMakesTheMotionUnknownUntilItSpeaksAgain) {
  fly(10.0, 14.0);
  for (double t = 10.0; t < 12.0; t += 0.05) subscriber_.add(mounting(t, 0.0), false);
  EXPECT_TRUE(at(11.5, "optical").valid);
  EXPECT_TRUE(at(12.3, "optical").valid) << "within motion_timeout";
  const Motion motion = at(13.0, "optical");
  EXPECT_FALSE(motion.valid);
  EXPECT_NE(motion.reason.find("gimbal"), std::string::npos) << motion.reason;
  subscriber_.add(mounting(13.2, 0.0), false);
  EXPECT_TRUE(at(13.25, "optical").valid);
}

TEST_F(MotionSubscriberTest, ReadyWaitsForSamplesAndTransforms) {
  fly(10.0, 12.0);
  EXPECT_TRUE(subscriber_.ready(ros::Time(12.0), "optical"));
  EXPECT_FALSE(subscriber_.ready(ros::Time(12.005), "optical"));
  fly(12.01, 12.1);
  EXPECT_TRUE(subscriber_.ready(ros::Time(12.005), "optical"));
  for (double t = 11.0; t < 11.99; t += 0.1) subscriber_.add(mounting(t, 0.0), false);
  EXPECT_FALSE(subscriber_.ready(ros::Time(12.005), "optical"));
  subscriber_.add(mounting(12.01, 0.0), false);
  EXPECT_TRUE(subscriber_.ready(ros::Time(12.005), "optical"));
}

TEST_F(MotionSubscriberTest, SlowTransformsAreWaitedForOnlyWhenTheyAreDue) {
  for (double t = 10.0; t < 12.05; t += 0.1) subscriber_.add(mounting(t, 0.0), false);
  fly(10.0, 12.3);
  EXPECT_TRUE(subscriber_.ready(ros::Time(12.03), "optical")) << "the next one comes at 12.1";
  EXPECT_FALSE(subscriber_.ready(ros::Time(12.09), "optical")) << "it may be there any moment";
  subscriber_.add(mounting(12.1, 0.0), false);
  EXPECT_TRUE(subscriber_.ready(ros::Time(12.09), "optical"));
}

TEST_F(MotionSubscriberTest, TransformsAreUsedWhateverTheirStampsRoundTo) {
  const auto exactly = [](std::uint32_t nanoseconds) { return ros::Time(1700000000, nanoseconds); };
  for (std::uint32_t odd = 0; odd < 40; ++odd) {
    MotionSubscriber subscriber{MotionConfig()};
    for (std::uint32_t i = 0; i < 20; ++i) {
      sensor_msgs::Imu rates = imu(1.0);
      rates.header.stamp = exactly(i * 10000000);
      subscriber.add(rates);
      nav_msgs::Odometry speed = odom(1.0);
      speed.header.stamp = rates.header.stamp;
      subscriber.add(speed);
    }
    tf2_msgs::TFMessage gimbal = mounting(1.0, 0.0);
    const ros::Time newest = exactly(100000000 + 7 * odd);
    for (const ros::Time& stamp : {exactly(50000000), newest}) {
      gimbal.transforms[0].header.stamp = stamp;
      subscriber.add(gimbal, false);
    }
    for (const ros::Time& image : {newest, exactly(150000000)}) {
      const Motion motion = subscriber.motionAt(image, "optical");
      EXPECT_TRUE(motion.valid) << motion.reason;
      EXPECT_EQ(subscriber.status().mounting, "tf") << newest;
    }
  }
}

TEST_F(MotionSubscriberTest, StartingOverForgetsSamples) {
  fly(10.0, 12.0);
  EXPECT_TRUE(at(11.5).valid);
  subscriber_.startOver(ros::Time(10.0));
  EXPECT_FALSE(at(11.5).valid);
  EXPECT_FALSE(subscriber_.ready(ros::Time(10.5), "")) << "what came before will come again";
  fly(10.0, 11.0);
  EXPECT_TRUE(subscriber_.ready(ros::Time(10.5), ""));
  EXPECT_TRUE(at(10.5).valid);
}

TEST_F(MotionSubscriberTest, StartingOverKeepsTransformsOfTheNewTime) {
  for (const double first : {60.0, 12.0}) {  // beyond TF's cache, and within
    for (int i = 0; i <= 10; ++i) {
      subscriber_.add(mounting(first + 0.1 * i, M_PI / 2), false);
      fly(first + 0.1 * i, first + 0.1 * i);
    }
    subscriber_.add(mounting(10.0, M_PI / 2), false);
    subscriber_.add(mounting(10.1, M_PI / 2), false);
    subscriber_.startOver(ros::Time(10.0));
    fly(10.0, 10.2);
    const Motion motion = at(10.1, "optical");
    EXPECT_NEAR(motion.yaw_rate, 0.0, 1e-6) << first;
    EXPECT_LT(motion.pitch_rate, -0.1) << first;
    EXPECT_EQ(subscriber_.status().mounting, "tf") << first;
    EXPECT_FALSE(at(first + 0.5, "optical").valid) << "the old time's are forgotten";
    subscriber_.startOver(ros::Time(10.0));
  }
}

TEST_F(MotionSubscriberTest, StartingOverWaitsForTransformsIfThereWereAny) {
  fly(10.0, 12.0);
  subscriber_.startOver(ros::Time(10.0));
  fly(10.0, 11.0);
  EXPECT_TRUE(subscriber_.ready(ros::Time(10.5), "optical"));
  subscriber_.add(mounting(10.4, 0.0), false);
  subscriber_.startOver(ros::Time(10.0));
  fly(10.0, 11.0);
  EXPECT_FALSE(subscriber_.ready(ros::Time(10.5), "optical"));
  subscriber_.add(mounting(10.5, 0.0), false);
  EXPECT_TRUE(subscriber_.ready(ros::Time(10.5), "optical"));
}

TEST_F(MotionSubscriberTest, WaitsNoLongerForSourcesThatDoNotComeBack) {
  fly(10.0, 12.0);
  subscriber_.startOver(ros::Time(10.0));
  EXPECT_FALSE(subscriber_.waitForMotion(ros::Time(10.5), "").valid);
  EXPECT_TRUE(subscriber_.ready(ros::Time(10.6), ""));
}

TEST_F(MotionSubscriberTest, TransformsAreUsedAgainAfterStampsFromTheFuture) {
  for (const double future : {1000.0, 2e9, 4294967295.0}) {
    subscriber_.add(mounting(future, 0.0), false);
    subscriber_.add(mounting(future, 0.0), false);
    for (int i = 0; i <= 10; ++i) subscriber_.add(mounting(11.0 + 0.1 * i, 0.0), false);
    fly(10.0, 12.0);
    EXPECT_TRUE(at(11.5, "optical").valid) << future;
    EXPECT_EQ(subscriber_.status().mounting, "tf") << future;
  }
}

TEST_F(MotionSubscriberTest, BadTransformsAreSurvived) {
  fly(10.0, 12.0);
  tf2_msgs::TFMessage nonsense = mounting(10.0, 0.0);
  nonsense.transforms[0].transform.rotation.x = std::nan("");
  subscriber_.add(nonsense, true);
  nonsense = mounting(10.0, 0.0);
  nonsense.transforms[0].child_frame_id.clear();
  subscriber_.add(nonsense, false);
  nonsense.transforms[0].header.frame_id.clear();
  subscriber_.add(nonsense, false);
  EXPECT_TRUE(at(11.5, "optical").valid);
  EXPECT_FALSE(at(0.0, "optical").valid);
}

}  // namespace
}  // namespace adaptive_grid_stereo
