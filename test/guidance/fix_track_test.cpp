#include "adaptive_grid_stereo/guidance/fix_track.h"

#include <cmath>

#include <gtest/gtest.h>

namespace adaptive_grid_stereo {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180.0;
// WGS84 at 47.4 degrees north, worked out by hand: radii of curvature along the meridian and
// across.
constexpr double kLatitude = 47.4;
constexpr double kMeridian = 6370066.9;  // [m]
constexpr double kNormal = 6389736.2;    // [m]

FixSample fixAt(double stamp, double east, double north, double up) {
  FixSample fix;
  fix.stamp = stamp;
  fix.latitude = kLatitude + north / kMeridian / kDegree;
  fix.longitude = 8.0 + east / (kNormal * std::cos(kLatitude * kDegree)) / kDegree;
  fix.altitude = up;
  return fix;
}

TEST(FixTrackTest, FindsASteadyVelocityInMetres) {
  SampleBuffer<FixSample> fixes(100);
  for (int i = 0; i <= 20; ++i)
    fixes.insert(fixAt(0.2 * i, 6.0 * i * 0.2, -8.0 * i * 0.2, 2.0 * i * 0.2), 0.5);
  const auto track = trackVelocity(fixes, 3.5, 2.0, 0.5);
  ASSERT_TRUE(track);
  EXPECT_NEAR(track->velocity.x(), 6.0, 0.01);
  EXPECT_NEAR(track->velocity.y(), -8.0, 0.01);
  EXPECT_NEAR(track->velocity.z(), 2.0, 0.01);
  EXPECT_NEAR(track->stamp, 2.4, 1e-6) << "the middle of 1.4 to 3.4 s";
}

TEST(FixTrackTest, SmoothsTheReceiversNoise) {
  SampleBuffer<FixSample> fixes(100);
  // Alternating +-0.25 m: neighbours differenced would be off by 2.5 m/s.
  for (int i = 0; i <= 20; ++i)
    fixes.insert(fixAt(0.2 * i, 5.0 * 0.2 * i + (i % 2 ? 0.25 : -0.25), 0, 0), 0.5);
  const auto track = trackVelocity(fixes, 4.0, 2.0, 0.5);
  ASSERT_TRUE(track);
  EXPECT_NEAR(track->velocity.x(), 5.0, 0.2);
}

TEST(FixTrackTest, NeedsEnoughFixesWithoutAGap) {
  SampleBuffer<FixSample> fixes(100);
  EXPECT_FALSE(trackVelocity(fixes, 1.0, 2.0, 0.5));
  for (const double stamp : {0.0, 0.4, 0.8}) fixes.insert(fixAt(stamp, stamp, 0, 0), 0.5);
  EXPECT_FALSE(trackVelocity(fixes, 0.8, 2.0, 0.5)) << "spans less than half the window";
  fixes.insert(fixAt(1.2, 1.2, 0, 0), 0.5);
  EXPECT_TRUE(trackVelocity(fixes, 1.2, 2.0, 0.5));
  fixes.insert(fixAt(2.0, 2.0, 0, 0), 0.5);
  EXPECT_FALSE(trackVelocity(fixes, 2.0, 2.0, 0.5)) << "alone after the gap";
}

TEST(FixTrackTest, CrossesTheDateLine) {
  SampleBuffer<FixSample> fixes(100);
  for (int i = 0; i <= 10; ++i) {
    FixSample fix = fixAt(0.2 * i, 0, 0, 0);
    fix.longitude = 179.9999 + i * 0.00004;
    if (fix.longitude > 180.0) fix.longitude -= 360.0;
    fixes.insert(fix, 0.5);
  }
  const auto track = trackVelocity(fixes, 2.0, 2.0, 0.5);
  ASSERT_TRUE(track);
  const double per_second = 0.0002 * kDegree * kNormal * std::cos(kLatitude * kDegree);
  EXPECT_NEAR(track->velocity.x(), per_second, 0.01);
}

}  // namespace
}  // namespace adaptive_grid_stereo
