#ifndef ADAPTIVE_GRID_STEREO_PATH_PLAN_H
#define ADAPTIVE_GRID_STEREO_PATH_PLAN_H

#include <array>
#include <stdexcept>
#include <string>

namespace adaptive_grid_stereo {

/// The one struct in which guidance and matching meet: nine cells, and the number of aggregation
/// paths that each of them gets.
///
/// Cells are numbered row by row from the top left (1 2 3 / 4 5 6 / 7 8 9); `paths[cell - 1]` holds
/// 4, 8 or 16. Cell column `c` covers the image columns [column_edges[c], column_edges[c + 1])
/// [px], likewise for rows. Edges never decrease, start at 0 and end at the image's size, so that
/// the cells tile the image exactly; an empty column or row is legal.
struct PathPlan {
  std::array<int, 4> column_edges{};
  std::array<int, 4> row_edges{};
  std::array<int, 9> paths{};

  bool operator==(const PathPlan& other) const {
    return column_edges == other.column_edges && row_edges == other.row_edges &&
           paths == other.paths;
  }
  bool operator!=(const PathPlan& other) const { return !(*this == other); }
};

/// The plan that gives every pixel of a width x height [px] image the same number of paths
/// (4, 8 or 16). The centre cell is the whole image, its neighbours are empty.
inline PathPlan uniformPlan(int width, int height, int paths) {
  PathPlan plan;
  plan.column_edges = {0, 0, width, width};
  plan.row_edges = {0, 0, height, height};
  plan.paths.fill(paths);
  return plan;
}

/// Mean number of paths per pixel [1], which the cost of aggregation is proportional to.
inline double meanPaths(const PathPlan& plan) {
  double sum = 0.0;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      sum += static_cast<double>(plan.paths[3 * row + column]) *
             (plan.column_edges[column + 1] - plan.column_edges[column]) *
             (plan.row_edges[row + 1] - plan.row_edges[row]);
    }
  }
  const double area = static_cast<double>(plan.column_edges[3]) * plan.row_edges[3];
  return area > 0.0 ? sum / area : 0.0;
}

/// Throws std::invalid_argument, naming the value found, unless the plan tiles a width x height
/// [px] image exactly and holds 4, 8 or 16 paths in every cell.
inline void checkPlan(const PathPlan& plan, int width, int height) {
  const auto checkEdges = [](const std::array<int, 4>& edges, int size, const char* name) {
    if (edges[0] != 0 || edges[3] != size || edges[1] < 0 || edges[2] < edges[1] ||
        edges[3] < edges[2]) {
      throw std::invalid_argument(
          std::string("path plan: ") + name + " [" + std::to_string(edges[0]) + ", " +
          std::to_string(edges[1]) + ", " + std::to_string(edges[2]) + ", " +
          std::to_string(edges[3]) + "] do not tile 0.." + std::to_string(size));
    }
  };
  checkEdges(plan.column_edges, width, "column_edges");
  checkEdges(plan.row_edges, height, "row_edges");
  for (const int paths : plan.paths) {
    if (paths != 4 && paths != 8 && paths != 16) {
      throw std::invalid_argument("path plan: " + std::to_string(paths) +
                                  " paths in a cell, expected 4, 8 or 16");
    }
  }
}

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_PATH_PLAN_H
