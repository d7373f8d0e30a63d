// Recorded flights through the same code as in the air: figures that hold on the logs themselves.
// The logs are not part of the package; without them the tests are skipped and say so.

#include <cmath>
#include <cstdlib>
#include <fstream>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "adaptive_grid_stereo/guidance/flight_state.h"
#include "motion_log.h"

namespace adaptive_grid_stereo {
namespace {

constexpr double kStart = 1600000000.0;  // of the fixed-wing log [s]

std::string dataFile(const std::string& name) {
  const char* data = std::getenv("ADAPTIVE_GRID_STEREO_DATA");
  return std::string(data != nullptr ? data : AGS_DEFAULT_DATA) + "/bags/" + name;
}

MotionTopics topicsOf(const BagReader& bag) {
  std::vector<std::string> notes;
  const MotionTopics topics = chooseMotionTopics(bag.connections(), NamedTopics(), &notes);
  EXPECT_TRUE(notes.empty()) << notes.front();
  return topics;
}

struct Answer {
  double time;  // since the log's start [s]
  Motion motion;
  FlightState state;
};

double rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}
double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

/// What the log itself says, read without the code under test.
struct Truth {
  struct Imu {
    double time;
    Eigen::Quaterniond orientation;
    Eigen::Vector3d rate;
  };
  struct Velocity {
    double time;
    Eigen::Vector3d enu;
  };
  std::vector<Imu> imu;
  std::vector<Velocity> velocity;

  template <typename Samples>
  static std::size_t before(const Samples& samples, double time) {
    std::size_t i = 0, step = samples.size();
    while (step > 0) {
      if (i + step < samples.size() && samples[i + step].time <= time) {
        i += step;
      } else {
        step /= 2;
      }
    }
    return i;
  }
  Eigen::Vector3d velocityAt(double time) const {
    const std::size_t i = std::min(before(velocity, time), velocity.size() - 2);
    const double share = (time - velocity[i].time) / (velocity[i + 1].time - velocity[i].time);
    return velocity[i].enu + share * (velocity[i + 1].enu - velocity[i].enu);
  }
  const Imu& imuAt(double time) const { return imu[before(imu, time)]; }
  double forwardSpeed(double time) const {
    return velocityAt(time).dot(imuAt(time).orientation * Eigen::Vector3d::UnitX());
  }
  double verticalRate(double time) const {
    return (imuAt(time).orientation * imuAt(time).rate).z();
  }
};

class FlightLogTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::ifstream(dataFile("fixed_wing_swiss.bag"))) {
      GTEST_SKIP() << dataFile("fixed_wing_swiss.bag") << " is not there";
    }
    bag_ = std::make_unique<BagReader>(dataFile("fixed_wing_swiss.bag"));
    for (BagMessage message; bag_->next(&message);) {
      const std::string& topic = message.connection->topic;
      if (topic == "/mavros/imu/data") {
        const auto m = deserialize<sensor_msgs::Imu>(message);
        truth_.imu.push_back(
            {m->header.stamp.toSec() - kStart,
             {m->orientation.w, m->orientation.x, m->orientation.y, m->orientation.z},
             {m->angular_velocity.x, m->angular_velocity.y, m->angular_velocity.z}});
      } else if (topic == "/mavros/global_position/raw/gps_vel") {
        const auto m = deserialize<geometry_msgs::TwistStamped>(message);
        truth_.velocity.push_back({m->header.stamp.toSec() - kStart,
                                   {m->twist.linear.x, m->twist.linear.y, m->twist.linear.z}});
      }
    }
  }

  /// Plays the log; `edit` may change an Imu message or feed transforms.
  std::vector<Answer> play(
      const MotionConfig& config, const std::string& frame = "",
      const std::function<void(sensor_msgs::Imu*, MotionSubscriber*)>& edit = nullptr) {
    MotionSubscriber subscriber(config);
    FlightStateMachine machine;
    std::vector<Answer> answers;
    MotionReplay replay;
    replay.optical_frame = frame;
    replay.topics = topicsOf(*bag_);
    const std::string imu_topic = replay.topics.imu;
    if (edit) {
      replay.topics.imu = "given below";
      replay.before_message = [&](const BagMessage& message) {
        if (message.connection->topic != imu_topic) return;
        const auto imu = deserialize<sensor_msgs::Imu>(message);
        edit(imu.get(), &subscriber);
        subscriber.add(*imu);
      };
    }
    replayMotion(bag_.get(), replay, &subscriber, [&](double stamp, const Motion& motion) {
      answers.push_back({stamp - kStart, motion, machine.update(motion, stamp, GuidanceConfig())});
    });
    return answers;
  }

  /// Answers in the air, and early enough that the truth can be interpolated.
  static bool flying(const Answer& answer) { return answer.time > 18.0 && answer.time < 99.5; }

  /// Means over 2 s windows of the yaw rate minus the GPS course rate, in the turns.
  std::vector<double> courseDifferences(const std::vector<Answer>& answers) const {
    std::vector<double> result;
    for (double from = 18.0; from < 97.0; from += 0.5) {
      const Eigen::Vector3d a = truth_.velocityAt(from), b = truth_.velocityAt(from + 2.0);
      double turned = 0.0;  // in small steps, as it may exceed pi
      Eigen::Vector3d last = a;
      for (double t = from + 0.2; t < from + 1.99; t += 0.2) {
        const Eigen::Vector3d now = truth_.velocityAt(t);
        turned +=
            std::atan2(last.x() * now.y() - last.y() * now.x(), last.head<2>().dot(now.head<2>()));
        last = now;
      }
      turned += std::atan2(last.x() * b.y() - last.y() * b.x(), last.head<2>().dot(b.head<2>()));
      if (std::abs(turned / 2.0) < 0.2) continue;
      std::vector<double> rates;
      for (const Answer& answer : answers) {
        if (answer.time >= from && answer.time < from + 2.0)
          rates.push_back(answer.motion.yaw_rate);
      }
      result.push_back(mean(rates) - turned / 2.0);
    }
    return result;
  }

  std::unique_ptr<BagReader> bag_;
  Truth truth_;
};

/// Body (FLU) to optical axes of a camera that stays level and looks where the body's nose points.
Eigen::Quaterniond bodyFromLevelCamera(const Eigen::Quaterniond& enu_from_body) {
  const Eigen::Vector3d forward = enu_from_body * Eigen::Vector3d::UnitX();
  const Eigen::Quaterniond enu_from_camera(
      Eigen::AngleAxisd(std::atan2(forward.y(), forward.x()), Eigen::Vector3d::UnitZ()));
  Eigen::Matrix3d camera_from_optical;
  camera_from_optical << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return enu_from_body.conjugate() * enu_from_camera * Eigen::Quaterniond(camera_from_optical);
}

TEST_F(FlightLogTest, StandsThenFliesAndTurnsMostlyLeft) {
  int left = 0, right = 0;
  for (const Answer& answer : play(MotionConfig())) {
    ASSERT_TRUE(answer.motion.valid) << answer.motion.reason << " at " << answer.time;
    EXPECT_EQ(answer.motion.speed_source, "gps_vel");
    EXPECT_EQ(answer.motion.rate_source, "imu");
    EXPECT_TRUE(answer.time >= 16.0 || answer.state.locked) << "at " << answer.time;
    EXPECT_TRUE(answer.time <= 17.5 || answer.state.forward) << "at " << answer.time;
    left += answer.state.yaw == YawSide::kLeft;
    right += answer.state.yaw == YawSide::kRight && answer.time > 18.0;
  }
  EXPECT_GT(left, 300);
  EXPECT_LT(right, left / 4);
}

TEST_F(FlightLogTest, ForwardSpeedIsTheGroundVelocityAlongTheNose) {
  std::vector<double> errors;
  int beyond = 0;
  for (const Answer& answer : play(MotionConfig())) {
    if (!flying(answer)) continue;
    errors.push_back(answer.motion.forward_speed - truth_.forwardSpeed(answer.time));
    beyond += std::abs(errors.back()) > 1.0;
  }
  EXPECT_LT(rms(errors), 0.4);
  EXPECT_LT(std::abs(mean(errors)), 0.1);
  // Between the receiver's samples at 5 Hz a hard manoeuvre may change more than 1 m/s.
  EXPECT_LT(beyond, 0.02 * errors.size());
}

TEST_F(FlightLogTest, CameraOnTheBodySeesTheBodysRates) {
  MotionConfig config;
  config.rate_filter_time = 0.0;
  for (const Answer& answer : play(config)) {
    const std::size_t i = Truth::before(truth_.imu, answer.time);
    if (i + 1 >= truth_.imu.size()) continue;
    const Eigen::Vector3d low = truth_.imu[i].rate.cwiseMin(truth_.imu[i + 1].rate);
    const Eigen::Vector3d high = truth_.imu[i].rate.cwiseMax(truth_.imu[i + 1].rate);
    EXPECT_GE(answer.motion.yaw_rate, low.z() - 1e-6);
    EXPECT_LE(answer.motion.yaw_rate, high.z() + 1e-6);
    EXPECT_GE(-answer.motion.pitch_rate, low.y() - 1e-6);
    EXPECT_LE(-answer.motion.pitch_rate, high.y() + 1e-6);
  }
}

/// Each camera here is level and at rest against the body at the moment of the question.
TEST_F(FlightLogTest, LevelCameraSeesTheVerticalPartOfTheRate) {
  MotionConfig config;
  config.rate_filter_time = 0.0;
  std::vector<double> errors;
  for (double time = 20.0; time < 99.0; time += 0.5) {
    const Truth::Imu& truth = truth_.imuAt(time);
    MotionSubscriber subscriber(config);
    for (std::size_t i = 0; i < truth_.imu.size(); ++i) {
      if (std::abs(truth_.imu[i].time - truth.time) > 0.3) continue;
      sensor_msgs::Imu imu;
      imu.header.stamp = ros::Time(kStart + truth_.imu[i].time);
      imu.header.frame_id = "base_link";
      imu.angular_velocity.x = truth_.imu[i].rate.x();
      imu.angular_velocity.y = truth_.imu[i].rate.y();
      imu.angular_velocity.z = truth_.imu[i].rate.z();
      subscriber.add(imu);
    }
    geometry_msgs::TwistStamped velocity;
    velocity.header.stamp = ros::Time(kStart + truth.time);
    subscriber.add(velocity);
    tf2_msgs::TFMessage tf;
    tf.transforms.resize(1);
    tf.transforms[0].header.frame_id = "base_link";
    tf.transforms[0].child_frame_id = "camera";
    const Eigen::Quaterniond q = bodyFromLevelCamera(truth.orientation);
    tf.transforms[0].transform.rotation.w = q.w();
    tf.transforms[0].transform.rotation.x = q.x();
    tf.transforms[0].transform.rotation.y = q.y();
    tf.transforms[0].transform.rotation.z = q.z();
    subscriber.add(tf, true);
    const Motion motion = subscriber.motionAt(velocity.header.stamp, "camera");
    ASSERT_TRUE(motion.valid) << motion.reason;
    errors.push_back(motion.yaw_rate - truth_.verticalRate(truth.time));
    EXPECT_LT(std::abs(errors.back()), 0.01) << "at " << time;
  }
  EXPECT_GT(errors.size(), 150u);
}

/// A gimbal that keeps the camera level all the time, by the log's own attitude.
TEST_F(FlightLogTest, LevelGimbalFollowsTheCourseInTheTurns) {
  const auto level = [](sensor_msgs::Imu* imu, MotionSubscriber* subscriber) {
    const Eigen::Quaterniond q = bodyFromLevelCamera(Eigen::Quaterniond(
        imu->orientation.w, imu->orientation.x, imu->orientation.y, imu->orientation.z));
    tf2_msgs::TFMessage tf;
    tf.transforms.resize(1);
    tf.transforms[0].header = imu->header;
    tf.transforms[0].child_frame_id = "camera";
    tf.transforms[0].transform.rotation.w = q.w();
    tf.transforms[0].transform.rotation.x = q.x();
    tf.transforms[0].transform.rotation.y = q.y();
    tf.transforms[0].transform.rotation.z = q.z();
    subscriber->add(tf, false);
  };
  const std::vector<Answer> answers = play(MotionConfig(), "camera", level);
  std::vector<double> pitch;
  for (const Answer& answer : answers) {
    if (!flying(answer)) continue;
    ASSERT_TRUE(answer.motion.valid) << answer.motion.reason;
    pitch.push_back(answer.motion.pitch_rate);
  }
  const std::vector<double> differences = courseDifferences(answers);
  ASSERT_GT(differences.size(), 50u);
  EXPECT_LT(rms(differences), 0.10);
  EXPECT_LT(std::abs(mean(differences)), 0.02);
  EXPECT_LT(std::abs(mean(pitch)), 0.02);
}

TEST_F(FlightLogTest, WithoutOrientationSpeedAndSignsHold) {
  const auto strip = [](sensor_msgs::Imu* imu, MotionSubscriber*) {
    imu->orientation = geometry_msgs::Quaternion();
    imu->orientation_covariance[0] = -1.0;
  };
  const std::vector<Answer> with = play(MotionConfig());
  const std::vector<Answer> without = play(MotionConfig(), "", strip);
  ASSERT_EQ(with.size(), without.size());
  std::vector<double> errors;
  int beyond = 0;
  for (std::size_t i = 0; i < without.size(); ++i) {
    EXPECT_EQ(without[i].motion.yaw_rate, with[i].motion.yaw_rate);
    EXPECT_EQ(without[i].motion.pitch_rate, with[i].motion.pitch_rate);
    if (!flying(without[i])) continue;
    errors.push_back(without[i].motion.forward_speed - truth_.forwardSpeed(without[i].time));
    beyond += std::abs(errors.back()) > 2.0;
    EXPECT_GT(without[i].motion.forward_speed, 0.0);
  }
  EXPECT_LT(rms(errors), 1.0);
  EXPECT_LT(beyond, 0.03 * errors.size());
}

TEST_F(FlightLogTest, FilterAndHysteresisCalmTheGrid) {
  const auto changes = [&](double filter, double hysteresis) {
    MotionConfig config;
    config.rate_filter_time = filter;
    GuidanceConfig guidance;
    guidance.hysteresis = hysteresis;
    FlightStateMachine machine;
    FlightState last;
    int n = 0;
    for (const Answer& answer : play(config)) {
      const FlightState state = machine.update(answer.motion, kStart + answer.time, guidance);
      n += state != last;
      last = state;
    }
    return n;
  };
  const int raw = changes(0.0, 1.0), both = changes(0.1, 0.8);
  RecordProperty("raw", raw);
  RecordProperty("both", both);
  EXPECT_LT(both, 0.6 * raw);
  EXPECT_LT(changes(0.1, 1.0), raw);
  EXPECT_LT(changes(0.0, 0.8), raw);
}

/// A live node asks as soon as its sources are ready and drops frames; the states stay those of the
/// unhurried run over all frames.
TEST_F(FlightLogTest, JustInTimeAndWithDroppedFramesTheStatesAreTheSame) {
  const std::vector<Answer> all = play(MotionConfig());
  for (const std::size_t every : {1u, 3u, 10u}) {
    MotionSubscriber subscriber((MotionConfig()));
    FlightStateMachine machine;
    const MotionTopics topics = topicsOf(*bag_);
    bag_->rewind();
    BagMessage message;
    bool more = bag_->next(&message);
    std::size_t different = 0, asked = 0;
    for (std::size_t i = 0; i < all.size(); i += every) {
      const ros::Time stamp(kStart + all[i].time);
      while (more && (message.time <= stamp || !subscriber.ready(stamp, ""))) {
        feedMotion(message, topics, &subscriber);
        more = bag_->next(&message);
      }
      const Motion motion = subscriber.motionAt(stamp, "");
      ++asked;
      different += machine.update(motion, stamp.toSec(), GuidanceConfig()) != all[i].state;
    }
    EXPECT_EQ(different, 0u) << "of " << asked << " states, every " << every << "th frame";
  }
}

TEST(RoverLogTest, OdometryFixesAndBothAgree) {
  const std::string path = dataFile("ground_rover_gps_imu_odom.bag");
  if (!std::ifstream(path)) GTEST_SKIP() << path << " is not there";
  BagReader bag(path);
  const auto speeds = [&](const std::string& source) {
    MotionConfig config;
    config.speed_source = source;
    MotionSubscriber subscriber(config);
    MotionReplay replay;
    replay.rate = 10.0;
    replay.topics = topicsOf(bag);
    std::vector<Motion> result;
    replayMotion(&bag, replay, &subscriber,
                 [&](double, const Motion& motion) { result.push_back(motion); });
    return result;
  };
  const auto odom = speeds("odom"), fixes = speeds("gps_fix"), both = speeds("auto");
  ASSERT_EQ(odom.size(), fixes.size());
  ASSERT_EQ(odom.size(), both.size());
  std::vector<double> fix_errors, both_errors;
  for (std::size_t i = 0; i < odom.size(); ++i) {
    if (!odom[i].valid || odom[i].forward_speed < 0.3) continue;
    ASSERT_TRUE(both[i].valid);
    both_errors.push_back(both[i].forward_speed - odom[i].forward_speed);
    if (fixes[i].valid) fix_errors.push_back(fixes[i].forward_speed - odom[i].forward_speed);
  }
  ASSERT_GT(fix_errors.size(), 3000u);
  EXPECT_LT(rms(fix_errors), 0.3);
  EXPECT_LT(rms(both_errors), 0.3);
}

}  // namespace
}  // namespace adaptive_grid_stereo
