// Thresholds and bag checks on small flights made up here.
#include <cmath>

#include <gtest/gtest.h>

#include "threshold_tuning.h"

namespace adaptive_grid_stereo {
namespace {

/// A minute at 50 Hz: ten seconds standing, then flight with a turn of five seconds every ten.
std::vector<MotionPoint> flight() {
  std::vector<MotionPoint> points;
  for (int i = 0; i < 3000; ++i) {
    const double t = 0.02 * i;
    MotionPoint point{100.0 + t, true, 0.0, 0.0, 0.0};
    if (t >= 10.0) {
      point.forward_speed = 16.2;
      point.yaw_rate = std::fmod(t, 10.0) < 5.0 ? 0.5 : 0.02;
      point.pitch_rate = 0.05 * std::sin(40.0 * t);
    }
    points.push_back(point);
  }
  return points;
}

GuidanceConfig config() {
  GuidanceConfig config;
  config.max_yaw_rate = 1.0;
  config.sigma1 = config.sigma2 = 0.3;
  return config;
}

TEST(ThresholdTuningTest, SharesChangesAndCost) {
  const TuningRow row = tuneAt(flight(), config());
  EXPECT_NEAR(row.locked, 10.0 / 60.0, 1e-3);
  EXPECT_NEAR(row.yaw, 25.0 / 60.0, 2e-3);
  EXPECT_NEAR(row.forward, 25.0 / 60.0, 2e-3);
  EXPECT_EQ(row.pitch, 0.0);
  EXPECT_EQ(row.both, 0.0);
  // Into flight and its first turn at once, then out of and into the turns: 1 + 9 in a minute.
  EXPECT_NEAR(row.changes_per_minute, 10.0, 0.1);
  // At 81 % of V_max the centre has a third: FORWARD (16 + 4 * 8 + 4 * 4) / 9 / 16, YAW 28 / 3
  // / 16.
  const double expected = 1.0 * 10 / 60 + 64.0 / 9 / 16 * 25 / 60 + 28.0 / 3 / 16 * 25 / 60;
  EXPECT_NEAR(row.cost, expected, 0.003);
}

TEST(ThresholdTuningTest, GridHasOneRowForEachPair) {
  const auto rows = tuneGrid(flight(), config(), {0.3, 0.6});
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_GT(rows[0].yaw, 0.3);
  EXPECT_EQ(rows[3].yaw, 0.0) << "0.5 rad/s is below 0.6";
}

TEST(ThresholdTuningTest, AdviceComesFromTheFlight) {
  const TuningAdvice advice = adviseThresholds(flight(), config());
  EXPECT_DOUBLE_EQ(advice.config.max_speed, 16.5);
  EXPECT_NEAR(advice.config.max_yaw_rate, 0.5, 1e-9);
  EXPECT_NEAR(advice.config.max_pitch_rate, 0.2, 1e-9) << "no less than is sensible";
  EXPECT_EQ(advice.reasons.size(), 5u);
  EXPECT_TRUE(GuidanceConfig(advice.config).validate().empty());
}

TEST(ThresholdTuningTest, PicksTheSmallestSigmaThatIsCalm) {
  // Noise of +-0.2 rad/s in straight flight under turns of 1.0 rad/s.
  std::vector<MotionPoint> points = flight();
  for (std::size_t i = 500; i < points.size(); ++i) {
    points[i].yaw_rate =
        std::fmod(points[i].stamp - 100.0, 10.0) < 5.0 ? 1.0 : (i % 8 < 4 ? 0.2 : -0.2);
  }
  const TuningAdvice advice = adviseThresholds(points, config());
  EXPECT_NEAR(advice.config.max_yaw_rate, 1.0, 1e-9);
  EXPECT_GE(advice.config.sigma1, 0.2);
  EXPECT_LE(advice.config.sigma1, 0.26);
}

/// A flight straight on, whose pitch swings by `rate` [rad/s], `swings` times a minute.
std::vector<MotionPoint> swinging(double rate, double swings) {
  std::vector<MotionPoint> points = flight();
  for (MotionPoint& point : points) {
    point.yaw_rate = 0.0;
    point.pitch_rate = rate * std::sin(2.0 * M_PI * swings / 60.0 * (point.stamp - 100.0));
  }
  return points;
}

TEST(ThresholdTuningTest, TheWobbleOfACalmFlightIsNoTurn) {
  const TuningAdvice advice = adviseThresholds(swinging(0.05, 5.0), config(), 20.0);
  EXPECT_GE(advice.config.sigma1 * advice.config.max_yaw_rate, 0.1 - 1e-9);
  EXPECT_GE(advice.config.sigma2 * advice.config.max_pitch_rate, 0.1 - 1e-9);
  EXPECT_EQ(tuneAt(swinging(0.05, 5.0), advice.config).pitch, 0.0);
}

TEST(ThresholdTuningTest, WhereNothingIsCalmTheGivenParametersStay) {
  // Each swing crosses even the largest sigma up and down, four changes.
  const auto points = swinging(1.0, 30.0);
  GuidanceConfig given = config();
  given.max_pitch_rate = 3.0;
  const TuningAdvice advice = adviseThresholds(points, given, 20.0);
  EXPECT_EQ(advice.config.max_pitch_rate, given.max_pitch_rate);
  EXPECT_EQ(advice.config.sigma2, given.sigma2);
  EXPECT_NE(advice.reasons.back().find("max_pitch_rate and sigma2: as given"), std::string::npos)
      << advice.reasons.back();
}

TEST(ThresholdTuningTest, MoreChangesThanWithTheGivenParametersAreSaid) {
  const auto points = swinging(0.2, 4.0);  // below the given threshold of 0.24 rad/s
  const TuningAdvice advice = adviseThresholds(points, config(), 20.0);
  EXPECT_GT(tuneAt(points, advice.config).changes_per_minute,
            tuneAt(points, config()).changes_per_minute);
  EXPECT_NE(advice.reasons.back().find("more often than with the parameters given"),
            std::string::npos)
      << advice.reasons.back();
}

TEST(ThresholdTuningTest, NothingToTuneByIsSaid) {
  std::vector<MotionPoint> standing(100, MotionPoint{1.0, true, 0.0, 0.5, 0.0});
  EXPECT_THROW(adviseThresholds(standing, config()), std::runtime_error);
  std::vector<MotionPoint> unknown(100);
  EXPECT_THROW(adviseThresholds(unknown, config()), std::runtime_error);
  EXPECT_EQ(tuneAt(unknown, config()).cost, 0.0);
}

}  // namespace
}  // namespace adaptive_grid_stereo
