#include "adaptive_grid_stereo/guidance/attitude_filter.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace adaptive_grid_stereo {
namespace {

constexpr double kGravity = 9.81;
const Eigen::Vector3d kField(0.0, 22.0, -42.0);  // northward and down, as in central Europe [uT]

Eigen::Quaterniond orientationOf(double yaw, double pitch_down, double roll_right) {
  return Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(pitch_down, Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(roll_right, Eigen::Vector3d::UnitX());
}

AttitudeInput standing(double stamp, const Eigen::Quaterniond& orientation) {
  AttitudeInput input;
  input.stamp = stamp;
  input.angular_rate.setZero();
  input.acceleration = orientation.conjugate() * Eigen::Vector3d(0.0, 0.0, kGravity);
  input.field = orientation.conjugate() * kField;
  return input;
}

double angleBetween(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  return a.angularDistance(b);
}

TEST(AttitudeFilterTest, StartsFromGravityAndField) {
  for (const double yaw : {-2.5, 0.0, 1.2, 3.0}) {
    for (const double pitch : {-0.6, 0.0, 0.4}) {
      const Eigen::Quaterniond truth = orientationOf(yaw, pitch, 0.5);
      const auto attitude = initialAttitude(standing(1.0, truth), 0.0);
      ASSERT_TRUE(attitude);
      EXPECT_LT(angleBetween(attitude->orientation, truth), 1e-6);
    }
  }
}

TEST(AttitudeFilterTest, DeclinationTurnsNorth) {
  // With magnetic north 0.1 rad east of true north, a body that points along the field's horizontal
  // part looks 0.1 rad to the right of true north.
  const auto attitude = initialAttitude(standing(1.0, orientationOf(M_PI / 2, 0, 0)), 0.1);
  ASSERT_TRUE(attitude);
  EXPECT_LT(angleBetween(attitude->orientation, orientationOf(M_PI / 2 - 0.1, 0, 0)), 1e-6);
}

TEST(AttitudeFilterTest, NeedsGravityAndField) {
  AttitudeInput falling = standing(1.0, orientationOf(0, 0, 0));
  falling.acceleration.setZero();
  EXPECT_FALSE(initialAttitude(falling, 0.0));
  AttitudeInput at_the_pole = standing(1.0, orientationOf(0, 0, 0));
  at_the_pole.field = Eigen::Vector3d(0.0, 0.0, -50.0);
  EXPECT_FALSE(initialAttitude(at_the_pole, 0.0));
}

TEST(AttitudeFilterTest, ConvergesFromAWrongStartAndFindsTheBias) {
  const Eigen::Quaterniond truth = orientationOf(0.7, -0.2, 0.3);
  const Eigen::Vector3d bias(0.02, -0.01, 0.015);
  Attitude attitude;
  attitude.stamp = 0.0;
  attitude.orientation = orientationOf(-0.5, 0.1, 0.0);
  for (int i = 1; i <= 12000; ++i) {
    AttitudeInput input = standing(0.01 * i, truth);
    input.angular_rate = bias;
    attitude = attitudeStep(attitude, input, 0.0);
  }
  EXPECT_LT(angleBetween(attitude.orientation, truth), 0.02);
  EXPECT_LT((attitude.gyro_bias - bias).norm(), 0.005);
}

/// A coordinated level turn: the accelerometer feels level flight, only heavier.
TEST(AttitudeFilterTest, HoldsTheBankInALongCoordinatedTurn) {
  const double bank = -0.7, speed = 18.0;                       // left
  const double turn_rate = -kGravity * std::tan(bank) / speed;  // left positive [rad/s]
  Attitude attitude = *initialAttitude(standing(0.0, orientationOf(0, 0, 0)), 0.0);
  Eigen::Quaterniond truth = orientationOf(0, 0, 0), last = truth;
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, 1.0);
  double worst_after_roll = 0.0;
  for (int i = 1; i <= 3000; ++i) {
    const double t = 0.01 * i;
    const double share = std::min(1.0, t / 1.0);
    truth = orientationOf(turn_rate * std::max(0.0, t - 0.5), 0.0, bank * share);
    AttitudeInput input;
    input.stamp = t;
    const Eigen::AngleAxisd turned(last.conjugate() * truth);
    input.angular_rate = turned.axis() * turned.angle() / 0.01;
    input.acceleration = Eigen::Vector3d(0, 0, kGravity / std::cos(bank * share));
    for (int k = 0; k < 3; ++k) input.acceleration[k] += 0.3 * noise(random);
    input.field = truth.conjugate() * kField;
    input.speed = speed;
    attitude = attitudeStep(attitude, input, 0.0);
    last = truth;
    if (t > 2.0)
      worst_after_roll = std::max(worst_after_roll, angleBetween(attitude.orientation, truth));
  }
  EXPECT_LT(worst_after_roll, 0.3)
      << "30 s in the turn; believing the accelerometer would lose all 0.7";
}

TEST(AttitudeTrackTest, DoesNotDependOnTheOrderOfArrival) {
  std::vector<ImuSample> samples(400);
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 0.3);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i].stamp = 10.0 + 0.01 * static_cast<double>(i);
    samples[i].angular_rate = Eigen::Vector3d(noise(random), noise(random), noise(random));
    samples[i].acceleration = Eigen::Vector3d(noise(random), noise(random), kGravity);
  }
  const auto input = [](const ImuSample& sample) {
    AttitudeInput result;
    result.stamp = sample.stamp;
    result.angular_rate = sample.angular_rate;
    result.acceleration = sample.acceleration;
    result.field = kField;
    return std::optional<AttitudeInput>(result);
  };
  const auto run = [&](bool late) {
    SampleBuffer<ImuSample> buffer(1000);
    AttitudeTrack track;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (late && i % 7 == 3) continue;
      track.invalidateFrom(buffer.insert(samples[i], 0.5));
      if (late && i % 7 == 6) track.invalidateFrom(buffer.insert(samples[i - 3], 0.5));
      track.at(samples[i].stamp, buffer, input, 0.0);
    }
    return track.at(13.9, buffer, input, 0.0);
  };
  const auto in_order = run(false), out_of_order = run(true);
  ASSERT_TRUE(in_order && out_of_order);
  // Samples 3, 10, ... are late by three; the last ones that are left out altogether lie at the
  // end.
  EXPECT_LT(angleBetween(in_order->orientation, out_of_order->orientation), 1e-9);
}

}  // namespace
}  // namespace adaptive_grid_stereo
