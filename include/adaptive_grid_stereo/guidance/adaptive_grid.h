#ifndef ADAPTIVE_GRID_STEREO_GUIDANCE_ADAPTIVE_GRID_H
#define ADAPTIVE_GRID_STEREO_GUIDANCE_ADAPTIVE_GRID_H

#include "adaptive_grid_stereo/guidance/flight_state.h"
#include "adaptive_grid_stereo/guidance/guidance_config.h"
#include "adaptive_grid_stereo/path_plan.h"

namespace adaptive_grid_stereo {

/// The plan for a frame of width x height [px]: edges by eq. 5 with its clamps, paths by the
/// distance of each cell from the focus (FORWARD: Manhattan distance from cell 5; YAW: columns;
/// PITCH: rows; both: the larger). LOCKED: paths_focus everywhere; motion unknown: paths_unknown
/// everywhere. forward_speed [m/s] counts only through its share of max_speed, clamped to [0, 1].
PathPlan makePathPlan(const FlightState& state, double forward_speed, const GuidanceConfig& config,
                      int width, int height);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_GUIDANCE_ADAPTIVE_GRID_H
