// Every kind of damage to the streams, at random but reproducibly: never a crash, never a number
// that is none, never motion from samples older than motion_timeout, recovery with the first good
// samples.
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "adaptive_grid_stereo/guidance/flight_state.h"
#include "adaptive_grid_stereo/guidance/motion_estimator.h"

namespace adaptive_grid_stereo {
namespace {

constexpr double kStart = 1000.0, kFaultsEnd = 1015.0, kEnd = 1020.0;
constexpr double kSpeed = 14.0, kYawRate = 0.2;

struct Event {
  double arrival = 0.0;
  int source = 0;  // 0 imu, 1 odom, 2 gps_vel, 3 gps_fix, 4 mag
  double stamp = 0.0;
  bool nan = false;
};

/// All the damage comes before kFaultsEnd.
std::vector<Event> damagedStreams(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const double periods[] = {0.005, 0.02, 0.2, 0.2, 0.1};
  std::vector<Event> events;
  for (int source = 0; source < 5; ++source) {
    const double drop = uniform(random) < 0.5 ? uniform(random) : 0.0;
    const double delay = uniform(random) < 0.5 ? uniform(random) : 0.0;
    const double gap_start = kStart + 10.0 * uniform(random), gap = 5.0 * uniform(random);
    for (int i = 0; kStart + i * periods[source] <= kEnd; ++i) {
      Event event;
      event.source = source;
      event.arrival = event.stamp = kStart + i * periods[source];
      if (event.stamp < kFaultsEnd - 1.0) {
        if (uniform(random) < drop) continue;
        if (event.stamp > gap_start && event.stamp < gap_start + gap) continue;
        event.arrival += delay * uniform(random);
        const double kind = uniform(random);
        if (kind < 0.02) event.nan = true;
        if (kind > 0.98) event.stamp += 100.0;  // from the future
        if (kind > 0.96 && kind < 0.98) events.push_back(event);
        if (kind > 0.94 && kind < 0.96) event.stamp -= 50.0;  // from far back
      }
      events.push_back(event);
    }
  }
  std::stable_sort(events.begin(), events.end(),
                   [](const Event& a, const Event& b) { return a.arrival < b.arrival; });
  return events;
}

class MotionFaultsTest : public ::testing::TestWithParam<unsigned> {
 protected:
  /// Whether an undamaged stamp was used within the timeout can be told from what was delivered.
  void deliver(const Event& event, MotionEstimator* estimator) {
    const double bad = event.nan ? std::nan("") : 0.0;
    switch (event.source) {
      case 0: {
        ImuSample sample;
        sample.stamp = event.stamp;
        sample.angular_rate = Eigen::Vector3d(bad, 0.0, kYawRate);
        sample.acceleration = Eigen::Vector3d(0.0, 0.0, 9.81);
        estimator->add(sample);
        break;
      }
      case 1: {
        OdometrySample sample;
        sample.stamp = event.stamp;
        sample.velocity = Eigen::Vector3d(kSpeed, bad, 0.0);
        sample.angular_rate = Eigen::Vector3d(0.0, 0.0, kYawRate);
        estimator->add(sample);
        break;
      }
      case 2:
        estimator->add(VelocitySample{event.stamp, {kSpeed + bad, 0.0, 0.0}});
        break;
      case 3: {
        FixSample sample;
        sample.stamp = event.stamp;
        sample.latitude = bad;
        sample.longitude = (event.stamp - kStart) * kSpeed / 6378137.0 * 180.0 / M_PI;
        estimator->add(sample);
        break;
      }
      default:
        estimator->add(MagneticSample{event.stamp, {bad, 22e-6, -42e-6}});
    }
    if (!event.nan) stamps_[event.source].push_back(event.stamp);
  }

  bool fresh(int source, double now, double timeout) const {
    return std::any_of(stamps_[source].begin(), stamps_[source].end(),
                       [&](double stamp) { return stamp <= now && now - stamp <= timeout; });
  }

  std::vector<double> stamps_[5];
};

TEST_P(MotionFaultsTest, NeverStaleNeverWildAlwaysBack) {
  const std::vector<Event> events = damagedStreams(GetParam());
  MotionConfig config;
  config.motion_timeout = 0.3;
  MotionEstimator estimator(config);
  FlightStateMachine machine;
  std::size_t next = 0;
  int valid = 0;
  for (double now = kStart; now <= kEnd; now += 0.033) {
    for (; next < events.size() && events[next].arrival <= now; ++next) {
      deliver(events[next], &estimator);
    }
    estimator.ready(now);
    const Motion motion = estimator.estimate(now, MountingLookup());
    const bool speed_fresh = fresh(1, now, 0.3) || fresh(2, now, 0.3) || fresh(3, now, 0.3);
    const bool rate_fresh = fresh(0, now, 0.3) || fresh(1, now, 0.3);
    ASSERT_TRUE(!motion.valid || (speed_fresh && rate_fresh)) << "stale motion at " << now;
    if (motion.valid) {
      ++valid;
      EXPECT_LE(motion.speed_age, 0.3 + 1e-6);
      EXPECT_LE(motion.rate_age, 0.3 + 1e-6);
      // Flies east; the heading that is estimated lags the gyro that turns all the time.
      EXPECT_GT(motion.forward_speed, 0.6 * kSpeed);
      EXPECT_LT(motion.forward_speed, kSpeed + 0.01);
      EXPECT_NEAR(motion.yaw_rate, kYawRate, 1e-6);
    } else {
      EXPECT_FALSE(motion.reason.empty());
      EXPECT_EQ(motion.forward_speed, 0.0);
    }
    const FlightState state = machine.update(motion, now, GuidanceConfig());
    EXPECT_EQ(state.motion_known, motion.valid);
    EXPECT_TRUE(motion.valid || now <= kFaultsEnd) << motion.reason << " at " << now;
  }
  EXPECT_GT(valid, 140) << "the last five seconds at least";
}

INSTANTIATE_TEST_SUITE_P(Seeds, MotionFaultsTest, ::testing::Range(0u, 40u));

TEST(MotionFaultsTest, LoopingBagAnswersTheSameInEveryLap) {
  MotionEstimator estimator{MotionConfig()};
  std::vector<double> first;
  for (int lap = 0; lap < 3; ++lap) {
    std::size_t asked = 0;
    for (int i = 0; i <= 500; ++i) {
      OdometrySample sample;
      sample.stamp = kStart + 0.02 * i;
      sample.velocity.x() = 0.1 * i;
      sample.angular_rate.z() = 0.3 * std::sin(0.05 * i);
      estimator.add(sample);
      if (i < 50 || i % 10 != 0) continue;
      const Motion motion = estimator.estimate(sample.stamp, MountingLookup());
      ASSERT_TRUE(motion.valid);
      if (lap == 0) {
        first.push_back(motion.yaw_rate);
      } else {
        EXPECT_NEAR(motion.yaw_rate, first[asked++], 1e-12) << "lap " << lap << ", sample " << i;
      }
    }
  }
  EXPECT_EQ(estimator.report().odom.counts.clock_jumps, 2u);
}

}  // namespace
}  // namespace adaptive_grid_stereo
