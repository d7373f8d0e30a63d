#ifndef ADAPTIVE_GRID_STEREO_TOOLS_MOTION_PLAN_H
#define ADAPTIVE_GRID_STEREO_TOOLS_MOTION_PLAN_H

#include <string>

#include <opencv2/core.hpp>

#include "adaptive_grid_stereo/guidance/guidance_config.h"
#include "adaptive_grid_stereo/path_plan.h"

namespace adaptive_grid_stereo {

/// A motion to plan for: forward speed [m/s], yaw rate (left positive) and pitch rate (up positive)
/// [rad/s].
struct PlannedMotion {
  double speed = 0.0;
  double yaw_rate = 0.0;
  double pitch_rate = 0.0;
};

struct MotionPlan {
  std::string state;  // e.g. "FORWARD YAW left"
  PathPlan plan;
};

/// State and plan of an aircraft that has just come to move so, for images of `size` [px].
MotionPlan planForMotion(const PlannedMotion& motion, const GuidanceConfig& config, cv::Size size);

/// The box around the cells that have the plan's largest number of paths; the whole image if that
/// is every cell.
cv::Rect focusOf(const PathPlan& plan);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_TOOLS_MOTION_PLAN_H
