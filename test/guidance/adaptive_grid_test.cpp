// Eq. 5: w = W - g (v / V_max) W, clamped to [center_min_fraction W, W], h likewise; paths by the
// distance of each cell from the focus: 16 >> distance.
#include "adaptive_grid_stereo/guidance/adaptive_grid.h"

#include <cmath>

#include <gtest/gtest.h>

namespace adaptive_grid_stereo {
namespace {

using Paths = std::array<int, 9>;

FlightState state(YawSide yaw = YawSide::kNone, PitchSide pitch = PitchSide::kNone) {
  FlightState state;
  state.motion_known = state.forward = true;
  state.yaw = yaw;
  state.pitch = pitch;
  return state;
}

Paths pathsOf(const FlightState& state) {
  return makePathPlan(state, 10.0, GuidanceConfig(), 90, 60).paths;
}

TEST(AdaptiveGridTest, ForwardGivesManhattanDistance) {
  EXPECT_EQ(pathsOf(state()), (Paths{4, 8, 4, 8, 16, 8, 4, 8, 4}));
}

TEST(AdaptiveGridTest, YawGivesColumns) {
  EXPECT_EQ(pathsOf(state(YawSide::kLeft)), (Paths{16, 8, 4, 16, 8, 4, 16, 8, 4}));
  EXPECT_EQ(pathsOf(state(YawSide::kRight)), (Paths{4, 8, 16, 4, 8, 16, 4, 8, 16}));
}

TEST(AdaptiveGridTest, PitchGivesRows) {
  EXPECT_EQ(pathsOf(state(YawSide::kNone, PitchSide::kUp)), (Paths{16, 16, 16, 8, 8, 8, 4, 4, 4}));
  EXPECT_EQ(pathsOf(state(YawSide::kNone, PitchSide::kDown)),
            (Paths{4, 4, 4, 8, 8, 8, 16, 16, 16}));
}

TEST(AdaptiveGridTest, BothGiveTheLargerDistance) {
  EXPECT_EQ(pathsOf(state(YawSide::kLeft, PitchSide::kUp)), (Paths{16, 8, 4, 8, 8, 4, 4, 4, 4}));
  EXPECT_EQ(pathsOf(state(YawSide::kRight, PitchSide::kUp)), (Paths{4, 8, 16, 4, 8, 8, 4, 4, 4}));
  EXPECT_EQ(pathsOf(state(YawSide::kLeft, PitchSide::kDown)), (Paths{4, 4, 4, 8, 8, 4, 16, 8, 4}));
  EXPECT_EQ(pathsOf(state(YawSide::kRight, PitchSide::kDown)), (Paths{4, 4, 4, 4, 8, 8, 4, 8, 16}));
}

TEST(AdaptiveGridTest, LockedGivesTheFocusEverywhere) {
  FlightState locked;
  locked.motion_known = locked.locked = true;
  const PathPlan plan = makePathPlan(locked, 0.0, GuidanceConfig(), 90, 60);
  EXPECT_EQ(plan.paths, (Paths{16, 16, 16, 16, 16, 16, 16, 16, 16}));
}

TEST(AdaptiveGridTest, UnknownGivesTheUniformPlan) {
  GuidanceConfig config;
  EXPECT_EQ(makePathPlan(FlightState(), 12.0, config, 91, 61), uniformPlan(91, 61, 8));
  config.paths_unknown = 16;
  EXPECT_EQ(makePathPlan(FlightState(), 12.0, config, 91, 61), uniformPlan(91, 61, 16));
}

TEST(AdaptiveGridTest, LadderIsAParameter) {
  GuidanceConfig config;
  config.paths_focus = 8;
  config.paths_near = 8;
  config.paths_far = 4;
  EXPECT_EQ(makePathPlan(state(YawSide::kLeft), 10.0, config, 90, 60).paths,
            (Paths{8, 8, 4, 8, 8, 4, 8, 8, 4}));
}

TEST(AdaptiveGridTest, CentreShrinksByEquationFive) {
  GuidanceConfig config;  // g = 2, V_max = 20, at least a third
  const auto columns = [&](double v) {
    return makePathPlan(state(), v, config, 900, 600).column_edges;
  };
  const auto rows = [&](double v) { return makePathPlan(state(), v, config, 900, 600).row_edges; };
  EXPECT_EQ(columns(0.0), (std::array<int, 4>{0, 0, 900, 900}));
  EXPECT_EQ(columns(2.0), (std::array<int, 4>{0, 90, 810, 900}));   // w = 900 - 180
  EXPECT_EQ(columns(5.0), (std::array<int, 4>{0, 225, 675, 900}));  // w = 450
  EXPECT_EQ(rows(5.0), (std::array<int, 4>{0, 150, 450, 600}));     // h = 300
  const std::array<int, 4> thirds = {0, 300, 600, 900};
  EXPECT_EQ(columns(20.0 / 3.0), thirds);  // V_max / 3: w = 300 = W / 3
  EXPECT_EQ(columns(10.0), thirds);        // V_max / 2: w would be 0
  EXPECT_EQ(columns(20.0), thirds);        // V_max: w would be -W
  EXPECT_EQ(columns(60.0), thirds);
  EXPECT_EQ(columns(-5.0), columns(0.0));
  EXPECT_EQ(columns(std::nan("")), columns(0.0));
  EXPECT_EQ(rows(20.0), (std::array<int, 4>{0, 200, 400, 600}));
}

TEST(AdaptiveGridTest, GainAndSmallestCentreAreParameters) {
  GuidanceConfig config;
  config.grid_gain = 0.5;
  EXPECT_EQ(makePathPlan(state(), 20.0, config, 800, 400).column_edges,
            (std::array<int, 4>{0, 200, 600, 800}));
  config.grid_gain = 0.0;
  EXPECT_EQ(makePathPlan(state(), 20.0, config, 800, 400).column_edges,
            (std::array<int, 4>{0, 0, 800, 800}));
  config.grid_gain = 100.0;
  config.center_min_fraction = 0.5;
  EXPECT_EQ(makePathPlan(state(), 20.0, config, 800, 400).column_edges,
            (std::array<int, 4>{0, 200, 600, 800}));
  config.center_min_fraction = 0.0;
  EXPECT_EQ(makePathPlan(state(), 20.0, config, 800, 400).column_edges,
            (std::array<int, 4>{0, 400, 400, 800}));
}

TEST(AdaptiveGridTest, EverySizeIsTiledWithTheCentreInTheMiddle) {
  const GuidanceConfig config;
  for (const int size : {1, 2, 3, 16, 17, 31, 143, 375, 450, 641, 1281}) {
    for (double v = 0.0; v <= 22.0; v += 0.37) {
      const PathPlan plan = makePathPlan(state(), v, config, size, size + 5);
      ASSERT_NO_THROW(checkPlan(plan, size, size + 5)) << size << " px at " << v << " m/s";
      const std::array<int, 4>& e = plan.column_edges;
      EXPECT_EQ(e[1] - e[0], e[3] - e[2]);
      const double w = size - 2.0 * std::min(v / 20.0, 1.0) * size;
      const double wanted = std::max(size / 3.0, w);
      EXPECT_GE(e[2] - e[1], wanted - 1e-5);
      EXPECT_LT(e[2] - e[1], wanted + 2.0);
    }
  }
}

}  // namespace
}  // namespace adaptive_grid_stereo
