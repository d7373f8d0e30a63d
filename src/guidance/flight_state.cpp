#include "adaptive_grid_stereo/guidance/flight_state.h"

#include <cmath>

namespace adaptive_grid_stereo {

namespace {

/// Entered above the threshold, left below hysteresis * threshold.
bool holds(double value, double threshold, double hysteresis, bool held) {
  return held ? value >= hysteresis * threshold : value > threshold;
}

/// Which side of a signed ratio is on: +1, -1 or 0, given the side that was on.
int sideOf(double ratio, double threshold, double hysteresis, int held) {
  if (held != 0 && holds(held * ratio, threshold, hysteresis, true)) return held;
  if (std::abs(ratio) > threshold) return ratio > 0.0 ? 1 : -1;
  return 0;
}

constexpr int signOf(YawSide side) {
  return side == YawSide::kLeft ? 1 : side == YawSide::kRight ? -1 : 0;
}
constexpr int signOf(PitchSide side) {
  return side == PitchSide::kUp ? 1 : side == PitchSide::kDown ? -1 : 0;
}
constexpr YawSide yawSide(int sign) {
  return sign > 0 ? YawSide::kLeft : sign < 0 ? YawSide::kRight : YawSide::kNone;
}
constexpr PitchSide pitchSide(int sign) {
  return sign > 0 ? PitchSide::kUp : sign < 0 ? PitchSide::kDown : PitchSide::kNone;
}

MotionPoint pointOf(const Motion& motion, double stamp) {
  MotionPoint point;
  point.stamp = stamp;
  point.valid = motion.valid;
  point.forward_speed = motion.forward_speed;
  point.yaw_rate = motion.yaw_rate;
  point.pitch_rate = motion.pitch_rate;
  return point;
}

bool usable(const MotionPoint& point) {
  return point.valid && std::isfinite(point.forward_speed) && std::isfinite(point.yaw_rate) &&
         std::isfinite(point.pitch_rate);
}

}  // namespace

std::string toString(const FlightState& state) {
  if (!state.motion_known) return "UNKNOWN";
  if (state.locked) return "LOCKED";
  std::string text = "FORWARD";
  if (state.yaw != YawSide::kNone) text += state.yaw == YawSide::kLeft ? " YAW left" : " YAW right";
  if (state.pitch != PitchSide::kNone) {
    text += state.pitch == PitchSide::kUp ? " PITCH up" : " PITCH down";
  }
  return text;
}

FlightStateMachine::Memory FlightStateMachine::step(const Memory& memory, const MotionPoint& point,
                                                    const GuidanceConfig& config) {
  Memory next;
  next.stamp = point.stamp;
  if (!usable(point)) return next;
  const FlightState& last = memory.state;
  const bool known = last.motion_known;
  const auto dwells = [&](double since) {
    return known && point.stamp - since < config.min_dwell_time;
  };

  FlightState& state = next.state;
  state.motion_known = true;
  state.forward = point.forward_speed > 0.0 && holds(point.forward_speed, config.lock_speed,
                                                     config.hysteresis, known && last.forward);
  if (dwells(memory.forward_since)) state.forward = last.forward;
  state.locked = !state.forward;
  next.forward_since = known && state.forward == last.forward ? memory.forward_since : point.stamp;
  if (state.locked) return next;

  const int last_yaw = signOf(last.yaw);
  int yaw =
      sideOf(point.yaw_rate / config.max_yaw_rate, config.sigma1, config.hysteresis, last_yaw);
  if (last_yaw != 0 && dwells(memory.yaw_since)) yaw = last_yaw;
  state.yaw = yawSide(yaw);
  next.yaw_since = yaw == last_yaw ? memory.yaw_since : point.stamp;

  const int last_pitch = signOf(last.pitch);
  int pitch = sideOf(point.pitch_rate / config.max_pitch_rate, config.sigma2, config.hysteresis,
                     last_pitch);
  if (last_pitch != 0 && dwells(memory.pitch_since)) pitch = last_pitch;
  state.pitch = pitchSide(pitch);
  next.pitch_since = pitch == last_pitch ? memory.pitch_since : point.stamp;
  return next;
}

FlightState FlightStateMachine::update(const Motion& motion, double stamp,
                                       const GuidanceConfig& config) {
  if (stamp < last_stamp_) reset();
  last_stamp_ = stamp;
  const Memory now = [&] {
    if (!motion.has_history) return step(memory_, pointOf(motion, stamp), config);
    for (const MotionPoint& point : motion.history) {
      if (point.stamp > memory_.stamp) memory_ = step(memory_, point, config);
    }
    return step(memory_, pointOf(motion, stamp), config);
  }();
  if (!motion.has_history) memory_ = now;
  return now.state;
}

void FlightStateMachine::reset() {
  memory_ = Memory();
  last_stamp_ = 0.0;
}

}  // namespace adaptive_grid_stereo
