#include "src/matching/pixel_kinds.h"

#include <algorithm>
#include <array>
#include <map>

namespace adaptive_grid_stereo {
namespace {

int cellOf(const std::array<int, 4>& edges, int position) {
  int cell = 0;
  while (position >= edges[cell + 1]) ++cell;
  return cell;
}

PixelKind kindOf(int paths) { return paths == 16 ? kEight : paths == 8 ? kFour : kTwo; }

// The cell of a row, and the first and last cell within reach of a path's step.
struct Reach {
  int cell, first, last;
  bool operator<(const Reach& other) const {
    return std::array<int, 3>{cell, first, last} <
           std::array<int, 3>{other.cell, other.first, other.last};
  }
};

Reach reachOf(const std::array<int, 4>& edges, int position) {
  return {cellOf(edges, position), cellOf(edges, std::max(0, position - kPathMargin)),
          cellOf(edges, std::min(edges[3] - 1, position + kPathMargin))};
}

}  // namespace

PathPlan turned(const PathPlan& plan) {
  PathPlan result;
  for (int i = 0; i < 4; ++i) {
    result.column_edges[i] = plan.column_edges[3] - plan.column_edges[3 - i];
    result.row_edges[i] = plan.row_edges[3] - plan.row_edges[3 - i];
  }
  for (int i = 0; i < 9; ++i) result.paths[i] = plan.paths[8 - i];
  return result;
}

void PixelKinds::assign(const PathPlan& original, bool upward) {
  const PathPlan plan = upward ? turned(original) : original;
  const int width = plan.column_edges[3], height = plan.row_edges[3];
  stride_ = static_cast<std::size_t>(width) + 2 * kPathMargin;
  tables_.clear();
  ends_.clear();
  directions_.clear();
  table_of_row_.resize(height);
  blocks_ = (width + kPenaltyBlock - 1) / kPenaltyBlock;
  std::map<Reach, int> known;
  for (int v = 0; v < height; ++v) {
    const Reach rows = reachOf(plan.row_edges, v);
    const auto inserted = known.emplace(rows, static_cast<int>(known.size()));
    table_of_row_[v] = inserted.first->second;
    if (!inserted.second) continue;
    tables_.resize(tables_.size() + stride_, kOutside);
    std::uint8_t* kinds = tables_.data() + tables_.size() - stride_ + kPathMargin;
    directions_.resize(directions_.size() + blocks_, 0);
    std::uint8_t* most = directions_.data() + directions_.size() - blocks_;
    for (int u = 0; u < width; ++u) {
      const Reach columns = reachOf(plan.column_edges, u);
      const int paths = plan.paths[3 * rows.cell + columns.cell];
      int most_near = paths;
      for (int row = rows.first; row <= rows.last; ++row) {
        for (int column = columns.first; column <= columns.last; ++column) {
          most_near = std::max(most_near, plan.paths[3 * row + column]);
        }
      }
      kinds[u] = static_cast<std::uint8_t>(kindOf(paths) | (most_near > paths ? kClearRest : 0));
      std::uint8_t& of_block = most[u / kPenaltyBlock];
      of_block = std::max(of_block, static_cast<std::uint8_t>(paths / 2));
    }
    ends_.resize(tables_.size());
    int* ends = ends_.data() + ends_.size() - stride_ + kPathMargin;
    int next = width + kPathMargin;
    for (int u = width + kPathMargin - 1; u >= -kPathMargin; --u) {
      if (u + 1 < width + kPathMargin && kinds[u] != kinds[u + 1]) next = u + 1;
      ends[u] = next;
    }
  }
}

}  // namespace adaptive_grid_stereo
