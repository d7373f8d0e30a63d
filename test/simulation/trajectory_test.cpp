#include "adaptive_grid_stereo/simulation/trajectory.h"

#include <cmath>

#include <gtest/gtest.h>

#include "adaptive_grid_stereo/simulation/flight_plan.h"

namespace adaptive_grid_stereo {
namespace simulation {
namespace {

constexpr double kStep = 1e-3;  // [s]

class DefaultFlight : public ::testing::Test {
 protected:
  const Trajectory flight_ = makeFlight(manoeuvresFromString("all"), 30.0);
};

TEST_F(DefaultFlight, VelocityIsTheDerivativeOfPosition) {
  for (double time = 0.05; time < 29.9; time += 0.037) {
    const Eigen::Vector3d difference =
        (flight_.at(time + kStep).position - flight_.at(time - kStep).position) / (2 * kStep);
    EXPECT_LT((difference - flight_.at(time).velocity).norm(), 1e-4) << "at " << time << " s";
  }
}

TEST_F(DefaultFlight, AccelerationIsTheDerivativeOfVelocity) {
  for (double time = 0.05; time < 29.9; time += 0.037) {
    const Eigen::Vector3d difference =
        (flight_.at(time + kStep).velocity - flight_.at(time - kStep).velocity) / (2 * kStep);
    EXPECT_LT((difference - flight_.at(time).acceleration).norm(), 1e-3) << "at " << time << " s";
  }
}

TEST_F(DefaultFlight, BodyRateTurnsOneAttitudeIntoTheNext) {
  for (double time = 0.05; time < 29.9; time += 0.037) {
    const Eigen::Quaterniond before = flight_.at(time - kStep).attitude;
    const Eigen::Quaterniond after = flight_.at(time + kStep).attitude;
    const Eigen::AngleAxisd turn(before.conjugate() * after);
    const Eigen::Vector3d rate = turn.angle() * turn.axis() / (2 * kStep);
    EXPECT_LT((rate - flight_.at(time).angular_rate).norm(), 1e-3) << "at " << time << " s";
  }
}

TEST_F(DefaultFlight, NosePointsAlongThePathAndNothingPullsSideways) {
  for (double time = 0.0; time <= 30.0; time += 0.037) {
    const FlightSample sample = flight_.at(time);
    const Eigen::Vector3d velocity = sample.bodyVelocity();
    EXPECT_NEAR(velocity.y(), 0.0, 1e-9);
    EXPECT_NEAR(velocity.z(), 0.0, 1e-9);
    EXPECT_GE(velocity.x(), -1e-9);
    EXPECT_NEAR(sample.specificForce().y(), 0.0, 1e-9);
    EXPECT_GT(sample.specificForce().z(), 2.0) << "the wings carry at " << time << " s";
  }
}

TEST(Trajectory, LevelTurnBanksByThePhysicsOfACoordinatedTurn) {
  constexpr double kSpeed = 13.0;
  SmoothProfile course;
  course.addChange(0.0, 10.0, 1.0, 0.45 * 9.0);  // 0.45 rad/s to the left
  const Trajectory flight(SmoothProfile(kSpeed), SmoothProfile(), course, {0, 0, 50}, 10.0);

  const FlightSample sample = flight.at(5.0);
  const double bank = std::atan(kSpeed * 0.45 / kGravity);
  const Eigen::Vector3d up = sample.attitude * Eigen::Vector3d::UnitZ();
  EXPECT_NEAR(std::acos(up.z()), bank, 1e-9);
  // Left wing down: the body's left axis points below the horizon.
  EXPECT_NEAR((sample.attitude * Eigen::Vector3d::UnitY()).z(), -std::sin(bank), 1e-9);
  // Body rates of a level turn (FLU): yaw rate cos(bank), nose up sin(bank), no roll.
  EXPECT_NEAR(sample.angular_rate.z(), 0.45 * std::cos(bank), 1e-6);
  EXPECT_NEAR(-sample.angular_rate.y(), 0.45 * std::sin(bank), 1e-6);
  EXPECT_NEAR(sample.angular_rate.x(), 0.0, 1e-6);
  // It feels 1 / cos(bank) of its weight, straight down through the seat.
  EXPECT_NEAR(sample.specificForce().z(), kGravity / std::cos(bank), 1e-9);
}

TEST(Trajectory, ACircleClosesAfterItsPeriod) {
  constexpr double kSpeed = 10.0;
  constexpr double kRate = 0.5;
  SmoothProfile course;
  course.addChange(0.0, 30.0, 1.0, kRate * 29.0);
  const Trajectory flight(SmoothProfile(kSpeed), SmoothProfile(), course, {1, 2, 3}, 30.0);
  const double period = 2.0 * M_PI / kRate;
  const Eigen::Vector3d start = flight.at(3.0).position;
  EXPECT_LT((flight.at(3.0 + period).position - start).norm(), 1e-6);
  EXPECT_NEAR((flight.at(3.0 + 0.5 * period).position - start).norm(), 2.0 * kSpeed / kRate, 1e-6);
}

TEST(Trajectory, StandingStillFeelsGravityAlone) {
  const Trajectory flight(SmoothProfile(0.0), SmoothProfile(), SmoothProfile(), {4, 5, 6}, 2.0);
  const FlightSample sample = flight.at(1.0);
  EXPECT_EQ(sample.velocity, Eigen::Vector3d::Zero());
  EXPECT_LT((sample.position - Eigen::Vector3d(4, 5, 6)).norm(), 1e-12);
  EXPECT_LT((sample.specificForce() - Eigen::Vector3d(0, 0, kGravity)).norm(), 1e-12);
  EXPECT_LT(sample.angular_rate.norm(), 1e-9);
}

TEST(SmoothProfile, ChangesByExactlyWhatWasAsked) {
  SmoothProfile profile(2.0);
  profile.addChange(1.0, 4.0, 0.5, -3.0);
  EXPECT_DOUBLE_EQ(profile.value(0.9), 2.0);
  EXPECT_NEAR(profile.value(2.5), 0.5, 1e-12);  // half way, by symmetry
  EXPECT_NEAR(profile.value(4.1), -1.0, 1e-12);
  EXPECT_EQ(profile.rate(0.9), 0.0);
  EXPECT_NEAR(profile.rate(2.5), -3.0 / 2.5, 1e-12);
  EXPECT_NEAR(profile.rate(4.1), 0.0, 1e-12);
}

}  // namespace
}  // namespace simulation
}  // namespace adaptive_grid_stereo
