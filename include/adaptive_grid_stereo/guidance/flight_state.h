#ifndef ADAPTIVE_GRID_STEREO_GUIDANCE_FLIGHT_STATE_H
#define ADAPTIVE_GRID_STEREO_GUIDANCE_FLIGHT_STATE_H

#include <string>

#include "adaptive_grid_stereo/guidance/guidance_config.h"
#include "adaptive_grid_stereo/guidance/motion.h"

namespace adaptive_grid_stereo {

/// Which way the camera turns; the focus lies on that side.
enum class YawSide { kNone, kLeft, kRight };
enum class PitchSide { kNone, kUp, kDown };

/// The system state of eq. 1; YAW and PITCH hold together with FORWARD, and with each other.
struct FlightState {
  bool motion_known = false;
  bool locked = false;
  bool forward = false;
  YawSide yaw = YawSide::kNone;
  PitchSide pitch = PitchSide::kNone;

  bool operator==(const FlightState& other) const {
    return motion_known == other.motion_known && locked == other.locked &&
           forward == other.forward && yaw == other.yaw && pitch == other.pitch;
  }
  bool operator!=(const FlightState& other) const { return !(*this == other); }
};

/// E.g. "LOCKED", "FORWARD", "FORWARD YAW left PITCH up", "UNKNOWN".
std::string toString(const FlightState& state);

/// Eq. 1 with lock speed, hysteresis and minimum dwell time. Remembers the last state; not thread
/// safe.
///
/// A state is entered above its threshold and left below hysteresis * threshold; a speed of zero or
/// less is always LOCKED. YAW and PITCH end with FORWARD. min_dwell_time holds LOCKED, FORWARD, and
/// each side of YAW and PITCH once they are entered.
class FlightStateMachine {
 public:
  /// The state at `stamp` [s]. Invalid motion gives a state with motion_known = false, and the next
  /// valid motion starts without memory, as does a stamp that lies before the last one. Where the
  /// motion has a history, memory is made of that alone.
  FlightState update(const Motion& motion, double stamp, const GuidanceConfig& config);

  /// Forgets the last state.
  void reset();

 private:
  struct Memory {
    FlightState state;
    double stamp = 0.0;
    double forward_since = 0.0;
    double yaw_since = 0.0;
    double pitch_since = 0.0;
  };

  static Memory step(const Memory& memory, const MotionPoint& point, const GuidanceConfig& config);

  Memory memory_;
  double last_stamp_ = 0.0;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_GUIDANCE_FLIGHT_STATE_H
