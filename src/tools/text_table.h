#ifndef ADAPTIVE_GRID_STEREO_TOOLS_TEXT_TABLE_H
#define ADAPTIVE_GRID_STEREO_TOOLS_TEXT_TABLE_H

#include <string>
#include <vector>

namespace adaptive_grid_stereo {

/// Lines of cells as text with aligned columns, the first flush left, the others flush right. The
/// first line is the heading, a rule follows it. Lines may have different lengths.
std::string textTable(const std::vector<std::vector<std::string>>& lines);

/// `value` with `decimals` digits after the point, in the "C" locale's form.
std::string fixed(double value, int decimals);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_TOOLS_TEXT_TABLE_H
