#include "adaptive_grid_stereo/guidance/rate_filter.h"

#include <gtest/gtest.h>

#include "adaptive_grid_stereo/guidance/motion_samples.h"

namespace adaptive_grid_stereo {
namespace {

SampleBuffer<ImuSample> samples(double interval, double from, double to, double (*rate)(double)) {
  SampleBuffer<ImuSample> buffer(10000);
  const int n = static_cast<int>((to - from) / interval + 0.5);
  for (int i = 0; i <= n; ++i) {
    ImuSample sample;
    sample.stamp = from + i * interval;
    sample.angular_rate.z() = rate(sample.stamp);
    buffer.insert(sample, 0.5);
  }
  return buffer;
}

double ramp(double t) { return 2.0 * t; }
double step(double t) { return t < 1.0 - 1e-9 ? 0.0 : 1.0; }

TEST(RateFilterTest, InterpolatesFastSources) {
  const auto fast = samples(0.01, 0.0, 1.0, ramp);
  EXPECT_NEAR(filteredRate(fast, 0.5037, 0.0, 0.5).z(), 2.0 * 0.5037, 1e-9);
}

TEST(RateFilterTest, HoldsSlowSources) {
  const auto slow = samples(0.1, 0.0, 1.0, ramp);
  EXPECT_NEAR(filteredRate(slow, 0.57, 0.0, 0.5).z(), 1.0, 1e-9);
}

TEST(RateFilterTest, IsAFirstOrderLowPass) {
  const auto fast = samples(0.005, 0.0, 2.0, step);
  // The step is a ramp from 0.995 to 1 s, hence its middle.
  for (const double t : {1.05, 1.1, 1.2, 1.5}) {
    EXPECT_NEAR(filteredRate(fast, t, 0.1, 0.5).z(), 1.0 - std::exp(-(t - 0.9975) / 0.1), 1e-3)
        << t;
  }
  EXPECT_EQ(filteredRate(fast, 0.9, 0.1, 0.5).z(), 0.0) << "causal";
}

TEST(RateFilterTest, LagsARampByItsTimeConstant) {
  const auto fast = samples(0.01, 0.0, 3.0, ramp);
  EXPECT_NEAR(filteredRate(fast, 2.5, 0.1, 0.5).z(), 2.0 * (2.5 - 0.1), 1e-3);
}

TEST(RateFilterTest, StartsAnewAfterAGap) {
  SampleBuffer<ImuSample> buffer(100);
  for (const double stamp : {0.0, 0.1, 0.2, 1.0}) {
    ImuSample sample;
    sample.stamp = stamp;
    sample.angular_rate.z() = stamp < 0.5 ? 5.0 : 1.0;
    buffer.insert(sample, 0.5);
  }
  EXPECT_NEAR(filteredRate(buffer, 1.0, 2.0, 0.5).z(), 1.0, 1e-9);
}

}  // namespace
}  // namespace adaptive_grid_stereo
