#include "text_table.h"

#include <algorithm>
#include <iomanip>
#include <locale>
#include <sstream>

namespace adaptive_grid_stereo {

std::string textTable(const std::vector<std::vector<std::string>>& lines) {
  std::vector<std::size_t> widths;
  for (const auto& line : lines) {
    if (line.size() > widths.size()) widths.resize(line.size(), 0);
    for (std::size_t i = 0; i < line.size(); ++i) widths[i] = std::max(widths[i], line[i].size());
  }
  std::ostringstream text;
  for (std::size_t row = 0; row < lines.size(); ++row) {
    for (std::size_t i = 0; i < lines[row].size(); ++i) {
      if (i > 0) text << "  ";
      text << (i == 0 ? std::left : std::right) << std::setw(static_cast<int>(widths[i]))
           << lines[row][i];
    }
    text << '\n';
    if (row > 0) continue;
    for (std::size_t i = 0; i < lines[0].size(); ++i) {
      text << (i > 0 ? "  " : "") << std::string(widths[i], '-');
    }
    text << '\n';
  }
  return text.str();
}

std::string fixed(double value, int decimals) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << std::fixed << std::setprecision(decimals) << value;
  return text.str();
}

}  // namespace adaptive_grid_stereo
