#include "motion_plan.h"

#include <algorithm>

#include "adaptive_grid_stereo/guidance/adaptive_grid.h"
#include "adaptive_grid_stereo/guidance/flight_state.h"

namespace adaptive_grid_stereo {

MotionPlan planForMotion(const PlannedMotion& planned, const GuidanceConfig& config,
                         cv::Size size) {
  Motion motion;
  motion.valid = true;
  motion.forward_speed = planned.speed;
  motion.yaw_rate = planned.yaw_rate;
  motion.pitch_rate = planned.pitch_rate;
  FlightStateMachine machine;
  const FlightState state = machine.update(motion, 0.0, config);
  return {toString(state), makePathPlan(state, planned.speed, config, size.width, size.height)};
}

cv::Rect focusOf(const PathPlan& plan) {
  const auto cellBox = [&plan](int cell) {
    const int row = cell / 3;
    const int column = cell % 3;
    return cv::Rect(cv::Point(plan.column_edges[column], plan.row_edges[row]),
                    cv::Point(plan.column_edges[column + 1], plan.row_edges[row + 1]));
  };
  int most = 0;
  for (int cell = 0; cell < 9; ++cell) {
    if (cellBox(cell).area() > 0) most = std::max(most, plan.paths[cell]);
  }
  cv::Rect focus;
  for (int cell = 0; cell < 9; ++cell) {
    if (plan.paths[cell] == most) focus |= cellBox(cell);
  }
  return focus;
}

}  // namespace adaptive_grid_stereo
