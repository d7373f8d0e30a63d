#ifndef ADAPTIVE_GRID_STEREO_SIMULATION_FLIGHT_PLAN_H
#define ADAPTIVE_GRID_STEREO_SIMULATION_FLIGHT_PLAN_H

#include <string>
#include <vector>

#include "adaptive_grid_stereo/simulation/trajectory.h"

namespace adaptive_grid_stereo {
namespace simulation {

/// What the aircraft can be asked to do; with the package's default thresholds each one shows the
/// state it is named after.
enum class Manoeuvre {
  kStand,    // on the runway, then take-off: LOCKED, then FORWARD of growing speed
  kForward,  // straight and level, gathering speed
  kYawLeft,  // banked turn, slow enough that the pitch rate stays small
  kYawRight,
  kPitchUp,    // sharp pull-up, gentle return to level
  kPitchDown,  // sharp push-over, gentle return to level, gathering speed
  kYawPitch    // steep turn: yaw and pitch rate of the camera at once
};

/// "stand", "forward", "yaw_left", "yaw_right", "pitch_up", "pitch_down", "yaw_pitch".
const char* toString(Manoeuvre manoeuvre);

/// A comma-separated list of those names in the order given; "all" means all of them. Throws
/// std::invalid_argument, listing the legal names.
std::vector<Manoeuvre> manoeuvresFromString(const std::string& list);

/// Where the camera stands and how high the aircraft flies, with which the landscape must fit [m].
constexpr double kStandingHeight = 2.0;
constexpr double kCruiseHeight = 6.5;

/// A flight of `duration` [s] through the manoeuvres in their order, from (0, 0), eastwards. A
/// longer flight repeats those in the air; a shorter one ends early. Without kStand it begins in
/// the air.
Trajectory makeFlight(const std::vector<Manoeuvre>& manoeuvres, double duration);

}  // namespace simulation
}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SIMULATION_FLIGHT_PLAN_H
