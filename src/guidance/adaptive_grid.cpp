#include "adaptive_grid_stereo/guidance/adaptive_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace adaptive_grid_stereo {

namespace {

/// Eq. 5 for one axis: the centre cell has size - gain * ratio * size, within its limits. Rounding
/// down the margins keeps cell 5 in the middle and never below its smallest size.
std::array<int, 4> edges(int size, double speed_ratio, const GuidanceConfig& config) {
  const double wanted = size - config.grid_gain * speed_ratio * size;
  const double centre = std::clamp(wanted, config.center_min_fraction * size, double(size));
  constexpr double kRoundOff = 1e-6;  // [px], so that an exact third is not rounded down
  const int margin = static_cast<int>(std::floor((size - centre) / 2.0 + kRoundOff));
  return {0, margin, size - margin, size};
}

/// Steps from the cell to the focus [cells], 0..2.
int distanceToFocus(int row, int column, const FlightState& state) {
  const bool yaw = state.yaw != YawSide::kNone;
  const bool pitch = state.pitch != PitchSide::kNone;
  if (!yaw && !pitch) return std::abs(row - 1) + std::abs(column - 1);
  const int focus_column = state.yaw == YawSide::kLeft ? 0 : 2;
  const int focus_row = state.pitch == PitchSide::kUp ? 0 : 2;
  return std::max(yaw ? std::abs(column - focus_column) : 0, pitch ? std::abs(row - focus_row) : 0);
}

}  // namespace

PathPlan makePathPlan(const FlightState& state, double forward_speed, const GuidanceConfig& config,
                      int width, int height) {
  if (!state.motion_known) return uniformPlan(width, height, config.paths_unknown);

  const double ratio = forward_speed / config.max_speed;
  const double speed_ratio = std::isfinite(ratio) ? std::clamp(ratio, 0.0, 1.0) : 0.0;
  PathPlan plan;
  plan.column_edges = edges(width, speed_ratio, config);
  plan.row_edges = edges(height, speed_ratio, config);
  const std::array<int, 3> ladder = {config.paths_focus, config.paths_near, config.paths_far};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      const int distance = state.locked ? 0 : distanceToFocus(row, column, state);
      plan.paths[3 * row + column] = ladder[distance];
    }
  }
  return plan;
}

}  // namespace adaptive_grid_stereo
