#include "adaptive_grid_stereo/simulation/flight_plan.h"

#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adaptive_grid_stereo/guidance/flight_state.h"

namespace adaptive_grid_stereo {
namespace simulation {
namespace {

FlightState stateAt(const Trajectory& flight, double time, FlightStateMachine* machine) {
  const FlightSample sample = flight.at(time);
  Motion motion;
  motion.valid = true;
  motion.forward_speed = sample.bodyVelocity().x();
  motion.yaw_rate = sample.angular_rate.z();     // left positive
  motion.pitch_rate = -sample.angular_rate.y();  // up positive
  return machine->update(motion, time, GuidanceConfig());
}

// The states of a flight at 10 Hz, by the default thresholds, each change once.
std::vector<std::string> statesOf(const Trajectory& flight) {
  FlightStateMachine machine;
  std::vector<std::string> states;
  for (double time = 0.0; time < flight.duration(); time += 0.1) {
    const std::string state = toString(stateAt(flight, time, &machine));
    if (states.empty() || states.back() != state) states.push_back(state);
  }
  return states;
}

// True if `wanted` occur in `states` in this order, whatever lies between.
bool occurInOrder(const std::vector<std::string>& wanted, const std::vector<std::string>& states) {
  std::size_t next = 0;
  for (const std::string& state : states) {
    if (next < wanted.size() && state == wanted[next]) ++next;
  }
  return next == wanted.size();
}

std::string join(const std::vector<std::string>& states) {
  std::string text;
  for (const std::string& state : states) text += state + "; ";
  return text;
}

TEST(FlightPlan, DefaultFlightGoesThroughAllStatesInOrder) {
  const std::vector<std::string> states = statesOf(makeFlight(manoeuvresFromString("all"), 30.0));
  EXPECT_TRUE(occurInOrder({"LOCKED", "FORWARD", "FORWARD YAW left", "FORWARD", "FORWARD YAW right",
                            "FORWARD", "FORWARD PITCH up", "FORWARD", "FORWARD PITCH down",
                            "FORWARD", "FORWARD YAW left PITCH up", "FORWARD"},
                           states))
      << join(states);
}

TEST(FlightPlan, EveryManoeuvreShowsItsOwnStateAndNoOther) {
  const std::map<std::string, std::set<std::string>> expected{
      {"forward", {"FORWARD"}},
      {"yaw_left", {"FORWARD", "FORWARD YAW left"}},
      {"yaw_right", {"FORWARD", "FORWARD YAW right"}},
      {"pitch_up", {"FORWARD", "FORWARD PITCH up"}},
      {"pitch_down", {"FORWARD", "FORWARD PITCH down"}},
      {"stand", {"LOCKED", "FORWARD"}}};
  for (const auto& [name, states] : expected) {
    // One round: a second one would begin at another speed.
    const double duration = name == "stand" ? 8.0 : 3.3;
    const std::vector<std::string> found =
        statesOf(makeFlight(manoeuvresFromString(name), duration));
    EXPECT_EQ(std::set<std::string>(found.begin(), found.end()), states)
        << name << ": " << join(found);
  }
}

TEST(FlightPlan, StraightFlightCoversSlowAndFast) {
  const Trajectory flight = makeFlight(manoeuvresFromString("all"), 30.0);
  FlightStateMachine machine;
  std::set<int> speeds;
  for (double time = 0.0; time < 30.0; time += 0.1) {
    if (toString(stateAt(flight, time, &machine)) == "FORWARD") {
      speeds.insert(static_cast<int>(flight.at(time).bodyVelocity().x()));
    }
  }
  for (const int speed : {1, 3, 5, 8, 13, 15})
    EXPECT_EQ(speeds.count(speed), 1u) << speed << " m/s";
}

TEST(FlightPlan, LongFlightRepeatsTheManoeuvresInTheAir) {
  const std::vector<std::string> states =
      statesOf(makeFlight(manoeuvresFromString("forward,yaw_left,yaw_right"), 40.0));
  int turns = 0;
  for (const std::string& state : states) turns += state == "FORWARD YAW left" ? 1 : 0;
  EXPECT_GE(turns, 3) << join(states);
}

TEST(FlightPlan, KeepsTheOrderAndRefusesUnknownNames) {
  EXPECT_EQ(manoeuvresFromString("yaw_right,stand"),
            (std::vector<Manoeuvre>{Manoeuvre::kYawRight, Manoeuvre::kStand}));
  EXPECT_THROW(manoeuvresFromString("looping"), std::invalid_argument);
  EXPECT_THROW(manoeuvresFromString(""), std::invalid_argument);
}

}  // namespace
}  // namespace simulation
}  // namespace adaptive_grid_stereo
