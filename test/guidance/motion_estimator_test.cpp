#include "adaptive_grid_stereo/guidance/motion_estimator.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace adaptive_grid_stereo {
namespace {

OdometrySample odometry(double stamp, double speed, double yaw_rate = 0.0) {
  OdometrySample sample;
  sample.stamp = stamp;
  sample.velocity.x() = speed;
  sample.angular_rate.z() = yaw_rate;
  return sample;
}

ImuSample imu(double stamp, double yaw_rate) {
  ImuSample sample;
  sample.stamp = stamp;
  sample.angular_rate.z() = yaw_rate;
  sample.acceleration.z() = 9.81;
  return sample;
}

FixSample fix(double stamp, double east) {
  FixSample sample;
  sample.stamp = stamp;
  sample.latitude = 0.0;
  sample.longitude = east / 6378137.0 * 180.0 / M_PI;
  return sample;
}

Motion at(const MotionEstimator& estimator, double stamp) {
  return estimator.estimate(stamp, MountingLookup());
}

TEST(MotionEstimatorTest, NothingIsKnownAtFirst) {
  const MotionEstimator estimator{MotionConfig()};
  const Motion motion = at(estimator, 1.0);
  EXPECT_FALSE(motion.valid);
  EXPECT_NE(motion.reason.find("odom none"), std::string::npos) << motion.reason;
  EXPECT_TRUE(estimator.ready(1.0));
}

TEST(MotionEstimatorTest, OdometryAloneServesForBoth) {
  MotionEstimator estimator{MotionConfig()};
  for (int i = 0; i <= 50; ++i) estimator.add(odometry(1.0 + 0.02 * i, 12.0, 0.4));
  const Motion motion = at(estimator, 2.0);
  ASSERT_TRUE(motion.valid) << motion.reason;
  EXPECT_NEAR(motion.forward_speed, 12.0, 1e-9);
  EXPECT_NEAR(motion.yaw_rate, 0.4, 1e-9);
  EXPECT_EQ(motion.speed_source, "odom");
  EXPECT_EQ(motion.rate_source, "odom");
}

TEST(MotionEstimatorTest, SpeedAloneIsNotEnough) {
  MotionEstimator estimator{MotionConfig()};
  estimator.add(VelocitySample{1.0, {5, 0, 0}});
  const Motion motion = at(estimator, 1.1);
  EXPECT_FALSE(motion.valid);
  EXPECT_NE(motion.reason.find("imu none"), std::string::npos) << motion.reason;
}

TEST(MotionEstimatorTest, SaysWhatFixesLackThatComeTooSeldom) {
  MotionEstimator estimator{MotionConfig()};
  for (int i = 0; i <= 10; ++i) estimator.add(fix(1.0 + i, 10.0 * i));
  const Motion motion = at(estimator, 11.1);
  EXPECT_FALSE(motion.valid);
  EXPECT_NE(motion.reason.find("gps_fix 0.10 s old (three fixes"), std::string::npos)
      << motion.reason;
  MotionConfig patient;
  patient.motion_timeout = 1.5;
  estimator.setConfig(patient);
  for (int i = 0; i <= 20; ++i) estimator.add(imu(11.0 + 0.01 * i, 0.0));
  const Motion known = at(estimator, 11.1);
  EXPECT_TRUE(known.valid) << known.reason;
  EXPECT_NEAR(known.forward_speed, 10.0, 0.01);
}

TEST(MotionEstimatorTest, InterpolatesFastOdometry) {
  MotionEstimator estimator{MotionConfig()};
  for (int i = 0; i <= 100; ++i) estimator.add(odometry(1.0 + 0.02 * i, 10.0 + 0.02 * i));
  EXPECT_NEAR(at(estimator, 2.013).forward_speed, 11.013, 1e-9);
}

TEST(MotionEstimatorTest, DelayShiftsTheStamp) {
  MotionConfig config;
  config.motion_delay = -0.2;
  MotionEstimator estimator(config);
  for (int i = 0; i <= 100; ++i) estimator.add(odometry(1.0 + 0.02 * i, 10.0 + 0.02 * i));
  EXPECT_NEAR(at(estimator, 2.2).forward_speed, 11.0, 1e-9);
}

TEST(MotionEstimatorTest, StaleAfterTheTimeoutAndBackWithOneSample) {
  MotionConfig config;
  config.motion_timeout = 0.3;
  MotionEstimator estimator(config);
  estimator.add(odometry(1.0, 12.0, 0.4));
  EXPECT_TRUE(at(estimator, 1.3 - 1e-6).valid);
  EXPECT_FALSE(at(estimator, 1.31).valid);
  EXPECT_FALSE(at(estimator, 0.99).valid) << "a sample after the stamp is no knowledge";
  estimator.add(odometry(5.0, 7.0, -0.4));
  const Motion motion = at(estimator, 5.01);
  ASSERT_TRUE(motion.valid);
  EXPECT_NEAR(motion.forward_speed, 7.0, 1e-9);
  EXPECT_NEAR(motion.yaw_rate, -0.4, 1e-9) << "nothing from before the gap";
}

TEST(MotionEstimatorTest, NamedSourceIsTheOnlyOne) {
  MotionConfig config;
  config.speed_source = "gps_vel";
  config.rate_source = "odom";
  MotionEstimator estimator(config);
  for (int i = 0; i <= 50; ++i) {
    estimator.add(odometry(1.0 + 0.02 * i, 12.0, 0.4));
    estimator.add(imu(1.0 + 0.02 * i, -0.3));
  }
  EXPECT_FALSE(at(estimator, 2.0).valid);
  estimator.add(VelocitySample{1.9, {3, 4, 0}});
  const Motion motion = at(estimator, 2.0);
  ASSERT_TRUE(motion.valid);
  EXPECT_NEAR(motion.forward_speed, 5.0, 1e-9);
  EXPECT_NEAR(motion.yaw_rate, 0.4, 1e-9);
  EXPECT_NEAR(motion.speed_age, 0.1, 1e-9);
}

TEST(MotionEstimatorTest, FixesServeWhereThereIsNothingElse) {
  MotionEstimator estimator{MotionConfig()};
  for (int i = 0; i <= 20; ++i) estimator.add(fix(1.0 + 0.2 * i, 8.0 * 0.2 * i));
  for (int i = 0; i <= 400; ++i) estimator.add(imu(1.0 + 0.01 * i, 0.1));
  const Motion motion = at(estimator, 5.0);
  ASSERT_TRUE(motion.valid);
  EXPECT_EQ(motion.speed_source, "gps_fix");
  EXPECT_NEAR(motion.forward_speed, 8.0, 0.01);
}

/// Odometry says 10 m/s and GPS 12; odometry stops for two seconds and comes back.
TEST(MotionEstimatorTest, ChangesOverWithoutAJump) {
  MotionEstimator estimator{MotionConfig()};
  for (int i = 0; i <= 500; ++i) {
    const double t = 1.0 + 0.02 * i;
    estimator.add(imu(t, 0.0));
    if (t < 4.0 || t > 6.0) estimator.add(odometry(t, 10.0));
    if (i % 10 == 0) estimator.add(VelocitySample{t, {12, 0, 0}});
  }
  double last = at(estimator, 3.0).forward_speed;
  EXPECT_NEAR(last, 10.0, 1e-9);
  for (double t = 3.0; t <= 9.0; t += 0.02) {
    const Motion motion = at(estimator, t);
    ASSERT_TRUE(motion.valid);
    EXPECT_LT(std::abs(motion.forward_speed - last), 0.25) << "at " << t;
    last = motion.forward_speed;
  }
  EXPECT_NEAR(at(estimator, 5.5).forward_speed, 12.0, 1e-9);
  EXPECT_EQ(at(estimator, 5.5).speed_source, "gps_vel");
  EXPECT_NEAR(at(estimator, 9.0).forward_speed, 10.0, 1e-9);
  EXPECT_EQ(at(estimator, 9.0).speed_source, "odom");
}

TEST(MotionEstimatorTest, StandingReceiversPeaksAreNoStart) {
  MotionEstimator estimator{MotionConfig()};
  const double speeds[] = {0.3, 0.4, 0.8, 0.4, 0.2, 3.0};
  for (int i = 0; i < 6; ++i) estimator.add(VelocitySample{1.0 + 0.2 * i, {speeds[i], 0, 0}});
  for (int i = 0; i <= 120; ++i) estimator.add(imu(1.0 + 0.01 * i, 0.0));
  EXPECT_NEAR(at(estimator, 1.45).forward_speed, 0.4, 1e-9);
  EXPECT_NEAR(at(estimator, 2.05).forward_speed, 3.0, 1e-9) << "a start counts at once";
}

TEST(MotionEstimatorTest, ImuThatLiesOnItsSideGivesNoOrientation) {
  MotionConfig config;
  config.velocity_axes = VelocityAxes::kEnu;
  MotionEstimator estimator(config);
  for (int i = 0; i <= 100; ++i) {
    ImuSample sample = imu(1.0 + 0.01 * i, 0.0);
    sample.acceleration = Eigen::Vector3d(0.0, 9.81, 0.0);
    sample.orientation = Eigen::Quaterniond(Eigen::AngleAxisd(2.0, Eigen::Vector3d::UnitZ()));
    estimator.add(sample);
    estimator.add(VelocitySample{sample.stamp, {6, 8, 0}});
  }
  EXPECT_NEAR(at(estimator, 2.0).forward_speed, 10.0, 1e-9);
  EXPECT_NE(estimator.report().warning.find("gravity"), std::string::npos);
}

TEST(MotionEstimatorTest, MagnetometerAndAccelerometerStandInForAnOrientation) {
  MotionConfig config;
  config.velocity_axes = VelocityAxes::kEnu;
  MotionEstimator estimator(config);
  // Heads north-west while the wind drives it north: forward part of 10 m/s is 10 cos 45.
  const Eigen::Quaterniond truth(Eigen::AngleAxisd(0.75 * M_PI, Eigen::Vector3d::UnitZ()));
  for (int i = 0; i <= 300; ++i) {
    const double t = 1.0 + 0.01 * i;
    estimator.add(MagneticSample{t, truth.conjugate() * Eigen::Vector3d(0, 22e-6, -42e-6)});
    estimator.add(imu(t, 0.0));
    estimator.add(VelocitySample{t, {0, 10, 0}});
  }
  EXPECT_NEAR(at(estimator, 4.0).forward_speed, 10.0 * std::cos(M_PI / 4), 0.05);
}

TEST(MotionEstimatorTest, OdometryThatComesLateCountsForTheAttitudeAsIfInTime) {
  MotionConfig config;
  config.velocity_axes = VelocityAxes::kEnu;
  // A flat turn, faster and faster: what pulls inwards is told from gravity by the speed.
  constexpr double kYawRate = 0.4;
  const auto speedWithOdometry = [&](bool late) {
    MotionEstimator estimator(config);
    std::vector<OdometrySample> held_up;
    for (int i = 0; i <= 300; ++i) {
      const double t = 1.0 + 0.01 * i, speed = 5.0 * t;
      const Eigen::Quaterniond truth(Eigen::AngleAxisd(kYawRate * t, Eigen::Vector3d::UnitZ()));
      estimator.add(MagneticSample{t, truth.conjugate() * Eigen::Vector3d(0, 22e-6, -42e-6)});
      ImuSample rates = imu(t, kYawRate);
      rates.acceleration.y() = speed * kYawRate;
      estimator.add(rates);
      OdometrySample sample = odometry(t, 0.0, kYawRate);
      sample.velocity = truth * Eigen::Vector3d(speed, 0, 0);
      if (late && t > 2.5 && i % 40 != 0) {
        held_up.push_back(sample);
      } else {
        estimator.add(sample);
      }
    }
    EXPECT_TRUE(at(estimator, 4.0).valid);  // before the rest comes
    for (const OdometrySample& sample : held_up) estimator.add(sample);
    return at(estimator, 4.0).forward_speed;
  };
  EXPECT_EQ(speedWithOdometry(true), speedWithOdometry(false));
}

TEST(MotionEstimatorTest, ReadyWaitsForWhatIsDue) {
  MotionEstimator estimator{MotionConfig()};
  for (int i = 0; i <= 100; ++i) {
    estimator.add(imu(1.0 + 0.01 * i, 0.0));
    if (i % 20 == 0) estimator.add(VelocitySample{1.0 + 0.01 * i, {5, 0, 0}});
  }
  EXPECT_TRUE(estimator.ready(2.0));
  EXPECT_FALSE(estimator.ready(2.005)) << "the next Imu sample is 5 ms away";
  estimator.add(imu(2.01, 0.0));
  EXPECT_TRUE(estimator.ready(2.005)) << "the velocity is not due before 2.2 s";
  for (int i = 2; i <= 25; ++i) estimator.add(imu(2.0 + 0.01 * i, 0.0));
  EXPECT_FALSE(estimator.ready(2.21)) << "a velocity is due";
  EXPECT_TRUE(estimator.ready(9.0)) << "silent sources are not waited for";
}

TEST(MotionEstimatorTest, RefusesWhatIsNoNumber) {
  MotionEstimator estimator{MotionConfig()};
  EXPECT_FALSE(estimator.add(odometry(1.0, std::nan(""))));
  EXPECT_FALSE(estimator.add(imu(std::nan(""), 0.1)));
  EXPECT_FALSE(estimator.add(fix(1.0, std::numeric_limits<double>::infinity())));
  EXPECT_TRUE(estimator.add(odometry(1.0, 5.0)));
  const EstimatorReport report = estimator.report();
  EXPECT_EQ(report.odom.invalid, 1u);
  EXPECT_EQ(report.imu.invalid, 1u);
  EXPECT_EQ(report.gps_fix.invalid, 1u);
  EXPECT_FALSE(at(estimator, std::nan("")).valid);
}

TEST(MotionEstimatorTest, NumbersBeyondAllNumbersAreNoMotion) {
  // Finite by themselves; the square root of the sum of their squares is not.
  MotionConfig config;
  config.velocity_axes = VelocityAxes::kEnu;
  MotionEstimator estimator{config};
  OdometrySample sample = odometry(1.0, 1e308, 0.1);
  sample.orientation.reset();
  sample.velocity.y() = 1e308;
  EXPECT_TRUE(estimator.add(sample));
  const Motion motion = at(estimator, 1.0);
  EXPECT_FALSE(motion.valid);
  EXPECT_EQ(motion.forward_speed, 0.0);
  EXPECT_NE(motion.reason.find("beyond"), std::string::npos) << motion.reason;
  EXPECT_TRUE(estimator.add(odometry(1.1, 5.0, 0.1)));
}

TEST(MotionEstimatorTest, StartingOverForgetsWhateverComesFirstImagesOrMotion) {
  for (const int motion_comes_first : {0, 1, 10, 40}) {
    MotionEstimator estimator{MotionConfig()}, fresh{MotionConfig()};
    for (int i = 0; i < 100; ++i) estimator.add(odometry(10.0 + 0.1 * i, 50.0, 0.9));
    const auto add = [&](int i) {
      const OdometrySample sample = odometry(10.0 + 0.02 * i, 5.0 + 0.1 * i, 0.01 * i);
      estimator.add(sample);
      fresh.add(sample);
    };
    for (int i = 0; i < motion_comes_first; ++i) add(i);
    estimator.startOver(10.0);
    EXPECT_EQ(estimator.ready(10.0), motion_comes_first > 0);
    for (int i = motion_comes_first; i < 50; ++i) add(i);
    for (const double stamp : {10.0, 10.01, 10.3, 10.9}) {
      const Motion expected = at(fresh, stamp), motion = at(estimator, stamp);
      EXPECT_TRUE(motion.valid);
      EXPECT_EQ(motion.forward_speed, expected.forward_speed) << motion_comes_first;
      EXPECT_EQ(motion.yaw_rate, expected.yaw_rate) << motion_comes_first << " " << stamp;
    }
  }
}

TEST(MotionEstimatorTest, WaitsForTheSourceThatAFadingOneLeavesAShareTo) {
  MotionEstimator estimator{MotionConfig()};
  const auto addVelocity = [&](double stamp) {
    VelocitySample sample;
    sample.stamp = stamp;
    sample.velocity.x() = 20.0;
    estimator.add(sample);
  };
  for (const double stamp : {9.4, 9.6, 9.8, 10.0}) addVelocity(stamp);
  for (int i = 0; i <= 50; ++i) estimator.add(odometry(10.1 + 0.02 * i, 5.0, 0.1));
  // The odometry came at 10.1 and has its full weight from 10.35 on.
  EXPECT_FALSE(estimator.ready(10.2)) << "a GPS velocity is due, and counts";
  EXPECT_TRUE(estimator.ready(10.8)) << "one is due, but would not count";
  addVelocity(10.2);
  EXPECT_TRUE(estimator.ready(10.2));
}

TEST(MotionEstimatorTest, ImagesThatStartOverAloneCostNoMotion) {
  MotionEstimator estimator{MotionConfig()};
  for (int i = 0; i < 100; ++i) estimator.add(odometry(10.0 + 0.02 * i, 5.0, 0.1));
  estimator.startOver(11.97);  // after one stamp from far in the future
  EXPECT_TRUE(at(estimator, 11.97).valid);
}

}  // namespace
}  // namespace adaptive_grid_stereo
