#include "adaptive_grid_stereo/simulation/flight_plan.h"

#include <algorithm>
#include <array>
#include <sstream>
#include <stdexcept>

namespace adaptive_grid_stereo {
namespace simulation {
namespace {

struct NamedManoeuvre {
  Manoeuvre manoeuvre;
  const char* name;
};
constexpr std::array<NamedManoeuvre, 7> kManoeuvres{{{Manoeuvre::kStand, "stand"},
                                                     {Manoeuvre::kForward, "forward"},
                                                     {Manoeuvre::kYawLeft, "yaw_left"},
                                                     {Manoeuvre::kYawRight, "yaw_right"},
                                                     {Manoeuvre::kPitchUp, "pitch_up"},
                                                     {Manoeuvre::kPitchDown, "pitch_down"},
                                                     {Manoeuvre::kYawPitch, "yaw_pitch"}}};

constexpr double kTurnSpeed = 9.0;   // [m/s]
constexpr double kDiveSpeed = 13.0;  // [m/s]
constexpr double kFastSpeed = 18.5;  // [m/s]

// Strings manoeuvres together; each begins and ends straight and level.
class Builder {
 public:
  explicit Builder(double speed) : profile_speed_(speed), speed_(speed) {}

  void add(Manoeuvre manoeuvre) {
    switch (manoeuvre) {
      case Manoeuvre::kStand:
        return standAndTakeOff();
      case Manoeuvre::kForward:
        return forward();
      case Manoeuvre::kYawLeft:
        return turn(1.25, 3.5);
      case Manoeuvre::kYawRight:
        return turn(-1.25, 3.5);
      case Manoeuvre::kPitchUp:
        return pitch(0.5, speed_);
      case Manoeuvre::kPitchDown:
        return pitch(-0.5, std::max(speed_, kDiveSpeed));
      case Manoeuvre::kYawPitch:
        turn(steep_side_ * 1.85, 3.6);
        steep_side_ = -steep_side_;
        return;
    }
  }

  double time() const { return time_; }

  Trajectory build(const Eigen::Vector3d& start, double duration) const {
    return Trajectory(profile_speed_, climb_, course_, start, duration);
  }

 private:
  void changeSpeed(double begin, double end, double ramp, double target) {
    if (target != speed_) profile_speed_.addChange(begin, end, ramp, target - speed_);
    speed_ = target;
  }

  void standAndTakeOff() {
    time_ += 2.2;
    changeSpeed(time_, time_ + 4.0, 0.6, kTurnSpeed);
    // Gentle enough to stay below the pitch threshold of 0.24 rad/s.
    climb_.addChange(time_ + 2.2, time_ + 4.2, 0.6, 0.26);
    climb_.addChange(time_ + 4.2, time_ + 6.2, 0.6, -0.26);
    time_ += 6.2;
  }

  void forward() {
    // Slow again before the next round of turns, else faster.
    const double target = speed_ >= kFastSpeed ? kTurnSpeed : kFastSpeed;
    const double length = std::max(1.8, std::abs(target - speed_) / 3.5 + 0.5);
    if (first_forward_ && speed_ <= kTurnSpeed) {
      time_ += 0.6;  // a moment of steady flight after take-off
    } else {
      changeSpeed(time_, time_ + length, 0.5, target);
      time_ += length;
    }
    first_forward_ = false;
  }

  void turn(double change, double length) {
    course_.addChange(time_, time_ + length, 0.8, change);
    time_ += length;
  }

  // Sharply at 0.42 rad/s, then back to level at 0.20 rad/s, which no threshold notices.
  void pitch(double change, double end_speed) {
    constexpr double kRamp = 0.45;
    const double sharp = std::abs(change) / 0.42 + kRamp;
    const double gentle = std::abs(change) / 0.20 + kRamp;
    climb_.addChange(time_, time_ + sharp, kRamp, change);
    climb_.addChange(time_ + sharp, time_ + sharp + gentle, kRamp, -change);
    changeSpeed(time_, time_ + sharp + gentle, 0.6, end_speed);
    time_ += sharp + gentle;
  }

  SmoothProfile profile_speed_;
  SmoothProfile climb_;
  SmoothProfile course_;
  double speed_;
  double time_ = 0.0;
  double steep_side_ = 1.0;
  bool first_forward_ = true;
};

}  // namespace

const char* toString(Manoeuvre manoeuvre) {
  for (const NamedManoeuvre& entry : kManoeuvres) {
    if (entry.manoeuvre == manoeuvre) return entry.name;
  }
  return "?";
}

std::vector<Manoeuvre> manoeuvresFromString(const std::string& list) {
  std::vector<Manoeuvre> result;
  if (list == "all") {
    // The fast straight comes last, a short slow one after take-off.
    return {Manoeuvre::kStand,   Manoeuvre::kForward,   Manoeuvre::kYawLeft,  Manoeuvre::kYawRight,
            Manoeuvre::kPitchUp, Manoeuvre::kPitchDown, Manoeuvre::kYawPitch, Manoeuvre::kForward};
  }
  std::stringstream stream(list);
  std::string name;
  while (std::getline(stream, name, ',')) {
    const auto* entry =
        std::find_if(kManoeuvres.begin(), kManoeuvres.end(),
                     [&name](const NamedManoeuvre& known) { return name == known.name; });
    if (entry == kManoeuvres.end()) {
      std::string names;
      for (const NamedManoeuvre& known : kManoeuvres) names += std::string(", ") + known.name;
      throw std::invalid_argument("there is no manoeuvre '" + name + "'; there are all" + names);
    }
    result.push_back(entry->manoeuvre);
  }
  if (result.empty()) throw std::invalid_argument("the list of manoeuvres is empty");
  return result;
}

Trajectory makeFlight(const std::vector<Manoeuvre>& manoeuvres, double duration) {
  const bool stands = !manoeuvres.empty() && manoeuvres.front() == Manoeuvre::kStand;
  Builder builder(stands ? 0.0 : kTurnSpeed);
  if (stands) builder.add(Manoeuvre::kStand);
  std::vector<Manoeuvre> in_the_air;
  std::copy_if(manoeuvres.begin(), manoeuvres.end(), std::back_inserter(in_the_air),
               [](Manoeuvre manoeuvre) { return manoeuvre != Manoeuvre::kStand; });
  while (!in_the_air.empty() && builder.time() < duration) {
    for (const Manoeuvre manoeuvre : in_the_air) builder.add(manoeuvre);
  }
  return builder.build({0.0, 0.0, stands ? kStandingHeight : kCruiseHeight}, duration);
}

}  // namespace simulation
}  // namespace adaptive_grid_stereo
