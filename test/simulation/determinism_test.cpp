// The disparities of a flight are the same bits on every SIMD target of this CPU and for any number
// of threads. (Not compared with constants: the images come from Embree, which rounds as the CPU's
// vectors do.)

#include <gtest/gtest.h>

#include "adaptive_grid_stereo/guidance/adaptive_grid.h"
#include "adaptive_grid_stereo/guidance/flight_state.h"
#include "adaptive_grid_stereo/matching/stereo_matcher.h"
#include "adaptive_grid_stereo/simulation/flight_plan.h"
#include "adaptive_grid_stereo/simulation/landscape.h"
#include "adaptive_grid_stereo/simulation/renderer.h"
#include "test/matching/checksum.h"

namespace adaptive_grid_stereo {
namespace {

struct Frame {
  cv::Mat left, right;
  PathPlan plan;
};

/// Every 10th frame of the default flight of simulate_flight (30 s at 10 Hz), with the plan of its
/// state.
std::vector<Frame> flightFrames() {
  const simulation::Trajectory flight =
      simulation::makeFlight(simulation::manoeuvresFromString("all"), 30.0);
  const simulation::Scene scene(simulation::makeLandscape(flight, simulation::LandscapeConfig()));
  const simulation::Renderer renderer(scene, simulation::RendererConfig());
  FlightStateMachine machine;
  const GuidanceConfig guidance;
  std::vector<Frame> frames;
  for (int i = 0; i < 300; i += 10) {
    const double time = 0.1 * i;
    const simulation::FlightSample sample = flight.at(time);
    Motion motion;
    motion.valid = true;
    motion.forward_speed = sample.bodyVelocity().x();
    motion.yaw_rate = sample.angular_rate.z();
    motion.pitch_rate = -sample.angular_rate.y();
    const simulation::StereoFrame seen =
        renderer.render(flight, time, static_cast<std::uint64_t>(i));
    const FlightState state = machine.update(motion, time, guidance);
    frames.push_back(
        {seen.left, seen.right,
         makePathPlan(state, motion.forward_speed, guidance, seen.left.cols, seen.left.rows)});
  }
  return frames;
}

std::vector<std::uint64_t> checksums(const std::vector<Frame>& frames, int threads) {
  MatcherConfig config;
  config.threads = threads;
  StereoMatcher matcher(config);
  std::vector<std::uint64_t> sums;
  for (const Frame& frame : frames) {
    sums.push_back(checksum(matcher.match(frame.left, frame.right, frame.plan).disparity));
  }
  return sums;
}

TEST(Determinism, FlightGivesTheSameBitsOnEveryTargetAndNumberOfThreads) {
  const std::vector<Frame> frames = flightFrames();
  std::vector<PathPlan> plans;
  for (const Frame& frame : frames) {
    if (std::find(plans.begin(), plans.end(), frame.plan) == plans.end())
      plans.push_back(frame.plan);
  }
  ASSERT_GE(plans.size(), 5U) << "the flight does not show enough states";
  const std::vector<std::uint64_t> expected = checksums(frames, 1);
  EXPECT_NE(expected.front(), expected.back());
  for (const std::string& target : simdTargets()) {
    useSimdTarget(target);
    for (const int threads : {1, 3}) {
      EXPECT_EQ(expected, checksums(frames, threads)) << target << ", " << threads << " threads";
    }
  }
  useSimdTarget("");
}

}  // namespace
}  // namespace adaptive_grid_stereo
