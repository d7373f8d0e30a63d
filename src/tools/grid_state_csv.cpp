#include "grid_state_csv.h"

#include <cstdio>
#include <locale>
#include <sstream>

namespace adaptive_grid_stereo {
namespace {

template <typename Array>
void addNumbered(const char* name, const Array& values, std::size_t first,
                 std::ostringstream* text) {
  for (std::size_t i = 0; i < values.size(); ++i) *text << ',' << name << '_' << first + i;
}

template <typename Array>
void addValues(const Array& values, std::ostringstream* text) {
  for (const auto value : values) *text << ',' << +value;
}

}  // namespace

std::string gridStateCsvHeader() {
  const GridState state;
  std::ostringstream text;
  text << "stamp,state,motion_valid,speed_source,rate_source,forward_speed,yaw_rate,pitch_rate,"
          "speed_ratio,yaw_ratio,pitch_ratio";
  addNumbered("column_edges", state.column_edges, 0, &text);
  addNumbered("row_edges", state.row_edges, 0, &text);
  addNumbered("paths", state.paths, 1, &text);
  addNumbered("density", state.density, 1, &text);
  addNumbered("nearest_range", state.nearest_range, 1, &text);
  text << ",governor_step,processing_time,latency,frames_dropped\n";
  return text.str();
}

std::string toCsvLine(const GridState& state) {
  char stamp[32];
  std::snprintf(stamp, sizeof(stamp), "%u.%09u", state.header.stamp.sec, state.header.stamp.nsec);
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(9);
  text << stamp << ',' << +state.state << ',' << +state.motion_valid << ',' << state.speed_source
       << ',' << state.rate_source << ',' << state.forward_speed << ',' << state.yaw_rate << ','
       << state.pitch_rate << ',' << state.speed_ratio << ',' << state.yaw_ratio << ','
       << state.pitch_ratio;
  addValues(state.column_edges, &text);
  addValues(state.row_edges, &text);
  addValues(state.paths, &text);
  addValues(state.density, &text);
  addValues(state.nearest_range, &text);
  text << ',' << +state.governor_step << ',' << state.processing_time << ',' << state.latency << ','
       << state.frames_dropped << '\n';
  return text.str();
}

}  // namespace adaptive_grid_stereo
