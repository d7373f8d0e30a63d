#include "adaptive_grid_stereo/simulation/sensors.h"

#include <cmath>

#include <gtest/gtest.h>

#include "adaptive_grid_stereo/simulation/flight_plan.h"

namespace adaptive_grid_stereo {
namespace simulation {
namespace {

class SensorsTest : public ::testing::Test {
 protected:
  static SensorConfig perfect() {
    SensorConfig config;
    config.noise_scale = 0.0;
    return config;
  }
  const Trajectory flight_ = makeFlight(manoeuvresFromString("all"), 30.0);
};

TEST_F(SensorsTest, WithoutNoiseTheyReadTheTruth) {
  const Sensors sensors(perfect());
  const FlightSample truth = flight_.at(26.0);
  EXPECT_EQ(sensors.imu(truth, 3).angular_rate, truth.angular_rate);
  EXPECT_EQ(sensors.imu(truth, 3).specific_force, truth.specificForce());
  EXPECT_EQ(sensors.odometry(truth, 3).velocity, truth.bodyVelocity());
  EXPECT_EQ(sensors.odometry(truth, 3).position, truth.position);
  EXPECT_EQ(sensors.gpsVelocity(truth, 3), truth.velocity);
  const Eigen::Vector3d field = truth.attitude * sensors.magneticField(truth, 3);
  EXPECT_LT((field - kMagneticField).norm(), 1e-12);
}

TEST_F(SensorsTest, FixesMoveOverTheEarthAsTheAircraftDoes) {
  const Sensors sensors(perfect());
  const FlightSample from = flight_.at(10.0);
  const FlightSample to = flight_.at(28.0);
  const GeodeticPosition a = sensors.gpsPosition(from, 0);
  const GeodeticPosition b = sensors.gpsPosition(to, 0);
  // Metres of a degree at this latitude, from the radii of curvature of WGS 84.
  const double latitude = kWorldOrigin.latitude * M_PI / 180.0;
  constexpr double kEquator = 6378137.0;
  constexpr double kEccentricity2 = 6.69437999014e-3;
  const double w = std::sqrt(1.0 - kEccentricity2 * std::pow(std::sin(latitude), 2));
  const double north = M_PI / 180.0 * kEquator * (1.0 - kEccentricity2) / (w * w * w);
  const double east = M_PI / 180.0 * kEquator / w * std::cos(latitude);
  const Eigen::Vector3d moved = to.position - from.position;
  ASSERT_GT(moved.norm(), 50.0);
  EXPECT_NEAR((b.longitude - a.longitude) * east, moved.x(), 0.02);
  EXPECT_NEAR((b.latitude - a.latitude) * north, moved.y(), 0.02);
  EXPECT_NEAR(b.altitude - a.altitude, moved.z(), 0.02);
}

TEST_F(SensorsTest, NoiseHasTheStatedSize) {
  const SensorConfig config;
  const Sensors sensors(config);
  const FlightSample truth = flight_.at(1.0);
  constexpr int kCount = 4000;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Vector3d square = Eigen::Vector3d::Zero();
  for (int i = 0; i < kCount; ++i) {
    const Eigen::Vector3d error = sensors.imu(truth, i).angular_rate - truth.angular_rate;
    mean += error / kCount;
    square += error.cwiseAbs2() / kCount;
  }
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(std::sqrt(square[axis] - mean[axis] * mean[axis]), config.gyro_noise,
                0.05 * config.gyro_noise);
    EXPECT_LT(std::abs(mean[axis]), 4.0 * config.gyro_bias);  // the bias stays
  }
}

TEST_F(SensorsTest, SameSeedSameReadingsOtherSeedOthers) {
  SensorConfig config;
  const FlightSample truth = flight_.at(12.0);
  const Eigen::Vector3d first = Sensors(config).imu(truth, 7).angular_rate;
  EXPECT_EQ(Sensors(config).imu(truth, 7).angular_rate, first);
  EXPECT_NE(Sensors(config).imu(truth, 8).angular_rate, first);
  config.seed = 2;
  EXPECT_NE(Sensors(config).imu(truth, 7).angular_rate, first);
}

TEST_F(SensorsTest, GyroIntegratesToTheAttitude) {
  // What any attitude filter relies on: 200 Hz readings, added up, follow the aircraft.
  const Sensors sensors(perfect());
  Eigen::Quaterniond attitude = flight_.at(0.0).attitude;
  constexpr double kStep = 0.005;
  for (int i = 0; i < 5999; ++i) {
    const Eigen::Vector3d rate = sensors.imu(flight_.at((i + 0.5) * kStep), i).angular_rate;
    const double angle = rate.norm() * kStep;
    if (angle > 0.0) attitude = attitude * Eigen::AngleAxisd(angle, rate.normalized());
  }
  EXPECT_LT(attitude.angularDistance(flight_.at(5999 * kStep).attitude), 1e-3);
}

}  // namespace
}  // namespace simulation
}  // namespace adaptive_grid_stereo
