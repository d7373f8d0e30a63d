#ifndef ADAPTIVE_GRID_STEREO_ROS_PARAMETER_VISITOR_H
#define ADAPTIVE_GRID_STEREO_ROS_PARAMETER_VISITOR_H

#include "adaptive_grid_stereo/guidance/guidance_config.h"
#include "adaptive_grid_stereo/guidance/motion_config.h"
#include "adaptive_grid_stereo/matching/matcher_config.h"

namespace adaptive_grid_stereo {

/// Each function calls visit(name, member) for every parameter of a struct, in the order of the
/// documentation: the one place that ties the members to their public names. Config may be const.

template <typename Config, typename Visitor>
void visitMatcherParameters(Config& config, Visitor&& visit) {
  visit("min_disparity", config.min_disparity);
  visit("disparity_range", config.disparity_range);
  visit("census_window", config.census_window);
  visit("penalty_small", config.penalty_small);
  visit("penalty_large", config.penalty_large);
  visit("penalty_large_min", config.penalty_large_min);
  visit("adaptive_penalty", config.adaptive_penalty);
  visit("uniqueness_ratio", config.uniqueness_ratio);
  visit("disp12MaxDiff", config.disp12_max_diff);
  visit("min_contrast", config.min_contrast);
  visit("speckle_size", config.speckle_size);
  visit("speckle_range", config.speckle_range);
  visit("subpixel", config.subpixel);
  visit("median_filter", config.median_filter);
  visit("threads", config.threads);
}

template <typename Config, typename Visitor>
void visitGuidanceParameters(Config& config, Visitor&& visit) {
  visit("lock_speed", config.lock_speed);
  visit("max_speed", config.max_speed);
  visit("max_yaw_rate", config.max_yaw_rate);
  visit("max_pitch_rate", config.max_pitch_rate);
  visit("sigma1", config.sigma1);
  visit("sigma2", config.sigma2);
  visit("hysteresis", config.hysteresis);
  visit("min_dwell_time", config.min_dwell_time);
  visit("grid_gain", config.grid_gain);
  visit("center_min_fraction", config.center_min_fraction);
  visit("paths_focus", config.paths_focus);
  visit("paths_near", config.paths_near);
  visit("paths_far", config.paths_far);
  visit("paths_unknown", config.paths_unknown);
}

template <typename Config, typename Visitor>
void visitMotionParameters(Config& config, Visitor&& visit) {
  visit("speed_source", config.speed_source);
  visit("rate_source", config.rate_source);
  visit("velocity_axes", config.velocity_axes);
  visit("gps_velocity_axes", config.gps_velocity_axes);
  visit("rate_axes", config.rate_axes);
  visit("tf_axes", config.tf_axes);
  visit("body_frame", config.body_frame);
  visit("camera_rpy", config.camera_rpy);
  visit("motion_delay", config.motion_delay);
  visit("motion_timeout", config.motion_timeout);
  visit("rate_filter_time", config.rate_filter_time);
  visit("fix_window", config.fix_window);
  visit("magnetic_declination", config.magnetic_declination);
  visit("motion_wait", config.motion_wait);
}

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_ROS_PARAMETER_VISITOR_H
