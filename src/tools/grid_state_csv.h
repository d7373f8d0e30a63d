#ifndef ADAPTIVE_GRID_STEREO_TOOLS_GRID_STATE_CSV_H
#define ADAPTIVE_GRID_STEREO_TOOLS_GRID_STATE_CSV_H

#include <string>

#include "adaptive_grid_stereo/GridState.h"

namespace adaptive_grid_stereo {

/// The columns, named as the message's fields; cells are numbered from 1 as
/// everywhere (paths_1 .. paths_9), edges from 0 (column_edges_0 .. column_edges_3). Ends with a
/// line break.
std::string gridStateCsvHeader();

/// One message as a line; the stamp in seconds with nine digits.
std::string toCsvLine(const GridState& state);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_TOOLS_GRID_STATE_CSV_H
