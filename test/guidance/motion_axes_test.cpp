// Signs and sizes in every combination of declared axes, against vectors written down by hand.
#include <cmath>

#include <gtest/gtest.h>

#include "adaptive_grid_stereo/guidance/motion_estimator.h"

namespace adaptive_grid_stereo {
namespace {

constexpr double kBank = M_PI / 4.0;
constexpr double kTurn = 0.392;  // [rad/s], 45 degrees at 25 m/s
constexpr double kBodyRate = 0.277;

Motion ask(const MotionConfig& config, const Eigen::Vector3d& rate, const Eigen::Vector3d& velocity,
           std::optional<Eigen::Quaterniond> imu_orientation = std::nullopt,
           const MountingLookup& mounting = MountingLookup()) {
  MotionEstimator estimator(config);
  for (int i = 0; i <= 100; ++i) {
    ImuSample imu;
    imu.stamp = 1.0 + 0.01 * i;
    imu.angular_rate = rate;
    imu.orientation = imu_orientation;
    imu.frame = "imu";
    estimator.add(imu);
    estimator.add(VelocitySample{imu.stamp, velocity});
  }
  return estimator.estimate(2.0, mounting);
}

TEST(MotionAxesTest, LeftTurnAndClimbInBothBodyAxes) {
  MotionConfig config;
  // FLU: turning left is +z, raising the nose is -y.
  Motion motion = ask(config, {0.0, -0.2, 0.3}, {10, 0, 0});
  ASSERT_TRUE(motion.valid) << motion.reason;
  EXPECT_NEAR(motion.yaw_rate, 0.3, 1e-9);
  EXPECT_NEAR(motion.pitch_rate, 0.2, 1e-9);
  // FRD: turning left is -z, raising the nose is +y.
  config.rate_axes = RateAxes::kBodyFrd;
  motion = ask(config, {0.0, 0.2, -0.3}, {10, 0, 0});
  EXPECT_NEAR(motion.yaw_rate, 0.3, 1e-9);
  EXPECT_NEAR(motion.pitch_rate, 0.2, 1e-9);
}

TEST(MotionAxesTest, RollTurnsTheImageButNoCell) {
  const Motion motion = ask(MotionConfig(), {0.8, 0.0, 0.0}, {10, 0, 0});
  EXPECT_NEAR(motion.yaw_rate, 0.0, 1e-9);
  EXPECT_NEAR(motion.pitch_rate, 0.0, 1e-9);
}

TEST(MotionAxesTest, BankedTurnIsYawAndPitchToAFixedCamera) {
  // 45 degrees of bank to the left: the vertical turn of 0.392 shows as q = r = 0.277 (FRD q up).
  const Motion motion = ask(MotionConfig(), {0.0, -kBodyRate, kBodyRate}, {25, 0, 0});
  EXPECT_NEAR(motion.yaw_rate, kBodyRate, 1e-9);
  EXPECT_NEAR(motion.pitch_rate, kBodyRate, 1e-9);
}

TEST(MotionAxesTest, BankedTurnIsYawAloneToALevelCamera) {
  // Roll to the left is negative about x in FLU; the gimbal turns the camera back by as much.
  const Eigen::Matrix3d optical_from_flu =
      (Eigen::Matrix3d() << 0, -1, 0, 0, 0, -1, 1, 0, 0).finished();
  Mounting level;
  level.optical_from_body =
      Eigen::Quaterniond(optical_from_flu) * Eigen::AngleAxisd(-kBank, Eigen::Vector3d::UnitX());
  const auto mounting = [&](const std::string& frame, double) {
    EXPECT_EQ(frame, "imu");
    return std::optional<Mounting>(level);
  };
  const Motion motion =
      ask(MotionConfig(), {0.0, -kBodyRate, kBodyRate}, {25, 0, 0}, std::nullopt, mounting);
  EXPECT_NEAR(motion.yaw_rate, kTurn, 1e-3);
  EXPECT_NEAR(motion.pitch_rate, 0.0, 1e-9);
}

const Eigen::Matrix3d kOpticalFromFlu =
    (Eigen::Matrix3d() << 0, -1, 0, 0, 0, -1, 1, 0, 0).finished();

TEST(MotionAxesTest, GimbalsOwnRateCounts) {
  // The body stands still; the gimbal pans left by 0.2 rad/s and ends up looking ahead.
  Mounting panning;
  panning.interval = 0.1;
  panning.optical_from_body = Eigen::Quaterniond(kOpticalFromFlu);
  panning.optical_from_body_before =
      Eigen::Quaterniond(kOpticalFromFlu) * Eigen::AngleAxisd(0.02, Eigen::Vector3d::UnitZ());
  const auto mounting = [&](const std::string&, double) {
    return std::optional<Mounting>(panning);
  };
  Motion motion = ask(MotionConfig(), {0, 0, 0}, {25, 0, 0}, std::nullopt, mounting);
  EXPECT_NEAR(motion.yaw_rate, 0.2, 1e-9);
  EXPECT_NEAR(motion.pitch_rate, 0.0, 1e-9);
  // The same pan on a body that turns right as fast: the camera keeps looking at one point.
  motion = ask(MotionConfig(), {0, 0, -0.2}, {25, 0, 0}, std::nullopt, mounting);
  EXPECT_NEAR(motion.yaw_rate, 0.0, 1e-9);
}

TEST(MotionAxesTest, GimbalThatCancelsARollSeesNone) {
  Mounting level;
  level.interval = 0.1;
  level.optical_from_body =
      Eigen::Quaterniond(kOpticalFromFlu) * Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX());
  level.optical_from_body_before =
      Eigen::Quaterniond(kOpticalFromFlu) * Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitX());
  const auto mounting = [&](const std::string&, double) { return std::optional<Mounting>(level); };
  const Motion motion = ask(MotionConfig(), {1.0, 0, 0}, {25, 0, 0}, std::nullopt, mounting);
  EXPECT_NEAR(motion.yaw_rate, 0.0, 1e-9);
  EXPECT_NEAR(motion.pitch_rate, 0.0, 1e-9);
}

TEST(MotionAxesTest, TransformsOfAnFrdTreeTakeFrdRates) {
  MotionConfig config;
  config.rate_axes = config.tf_axes = RateAxes::kBodyFrd;
  Mounting frd;  // optical (right, down, forward) from (forward, right, down)
  frd.optical_from_body =
      Eigen::Quaterniond((Eigen::Matrix3d() << 0, 1, 0, 0, 0, 1, 1, 0, 0).finished());
  const auto mounting = [&](const std::string&, double) { return std::optional<Mounting>(frd); };
  const Motion motion = ask(config, {0.0, 0.2, -0.3}, {10, 0, 0}, std::nullopt, mounting);
  EXPECT_NEAR(motion.yaw_rate, 0.3, 1e-9);
  EXPECT_NEAR(motion.pitch_rate, 0.2, 1e-9);
}

TEST(MotionAxesTest, CameraRpyTurnsTheCameraOnTheBody) {
  MotionConfig config;
  config.camera_rpy = {{0.0, M_PI / 2.0, 0.0}};  // looks straight down
  // A turn of the aircraft rolls the view of a camera that looks down; rolling right swings it
  // left.
  Motion motion = ask(config, {0.0, 0.0, 0.3}, {10, 0, 0});
  EXPECT_NEAR(motion.yaw_rate, 0.0, 1e-9);
  EXPECT_NEAR(motion.pitch_rate, 0.0, 1e-9);
  motion = ask(config, {0.4, 0.0, 0.0}, {10, 0, 0});
  EXPECT_NEAR(motion.yaw_rate, 0.4, 1e-9);

  config.camera_rpy = {{0.0, 0.0, M_PI / 2.0}};  // looks to the left
  motion = ask(config, {0.5, 0.0, 0.3}, {10, 0, 0});
  EXPECT_NEAR(motion.yaw_rate, 0.3, 1e-9);
  EXPECT_NEAR(motion.pitch_rate, 0.5, 1e-9) << "rolling right lifts the view over the left wing";
}

TEST(MotionAxesTest, MountingThatWentSilentMakesTheMotionInvalid) {
  Mounting silent;
  silent.error = "the gimbal is silent";
  const auto mounting = [&](const std::string&, double) { return std::optional<Mounting>(silent); };
  const Motion motion = ask(MotionConfig(), {0, 0, 0.3}, {10, 0, 0}, std::nullopt, mounting);
  EXPECT_FALSE(motion.valid);
  EXPECT_EQ(motion.reason, "the gimbal is silent");
  EXPECT_EQ(motion.yaw_rate, 0.0);
}

TEST(MotionAxesTest, EarthVelocitiesAreProjectedOnTheForwardAxis) {
  // Heading 30 degrees north of east, nose up by 20 degrees (FLU: pitch -20 degrees about y).
  const Eigen::Quaterniond enu_from_flu = Eigen::AngleAxisd(M_PI / 6, Eigen::Vector3d::UnitZ()) *
                                          Eigen::AngleAxisd(-M_PI / 9, Eigen::Vector3d::UnitY());
  const Eigen::Vector3d forward(std::cos(M_PI / 9) * std::cos(M_PI / 6),
                                std::cos(M_PI / 9) * std::sin(M_PI / 6), std::sin(M_PI / 9));
  const Eigen::Vector3d wind(2.0, -1.0, 0.5);
  const Eigen::Vector3d velocity = 12.0 * forward + wind;
  const double expected = 12.0 + forward.dot(wind);

  MotionConfig config;
  config.velocity_axes = VelocityAxes::kEnu;
  EXPECT_NEAR(ask(config, {0, 0, 0}, velocity, enu_from_flu).forward_speed, expected, 1e-9);
  config.velocity_axes = VelocityAxes::kBodyFlu;  // gps/vel is of the earth all the same
  EXPECT_NEAR(ask(config, {0, 0, 0}, velocity, enu_from_flu).forward_speed, expected, 1e-9);
  config.gps_velocity_axes = "body_flu";
  EXPECT_NEAR(ask(config, {0, 0, 0}, velocity, enu_from_flu).forward_speed, velocity.x(), 1e-9);

  // The same in a stack that speaks of FRD bodies and NED: north = y, east = x, down = -z.
  config = MotionConfig();
  config.velocity_axes = VelocityAxes::kNed;
  config.rate_axes = RateAxes::kBodyFrd;
  const Eigen::Quaterniond ned_from_frd =
      Eigen::AngleAxisd(M_PI / 2 - M_PI / 6, Eigen::Vector3d::UnitZ()) *
      Eigen::AngleAxisd(M_PI / 9, Eigen::Vector3d::UnitY());
  const Eigen::Vector3d ned(velocity.y(), velocity.x(), -velocity.z());
  EXPECT_NEAR(ask(config, {0, 0, 0}, ned, ned_from_frd).forward_speed, expected, 1e-9);
}

TEST(MotionAxesTest, WithoutOrientationTheGroundSpeedServes) {
  MotionConfig config;
  config.velocity_axes = VelocityAxes::kEnu;
  EXPECT_NEAR(ask(config, {0, 0, 0}, {3, -4, 2}).forward_speed, 5.0, 1e-9);
}

}  // namespace
}  // namespace adaptive_grid_stereo
