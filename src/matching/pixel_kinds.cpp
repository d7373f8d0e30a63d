#include "src/matching/pixel_kinds.h"

#include <algorithm>
#include <array>

namespace adaptive_grid_stereo {
namespace {

int cellOf(const std::array<int, 4>& edges, int position) {
  int cell = 0;
  while (position >= edges[cell + 1]) ++cell;
  return cell;
}

PixelKind kindOf(int paths) { return paths == 16 ? kEight : paths == 8 ? kFour : kTwo; }

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
  const int width = plan.column_edges[3];
  stride_ = static_cast<std::size_t>(width) + 2 * kPathMargin;
  blocks_ = (width + kLargestLag + kPenaltyBlock - 1) / kPenaltyBlock;
  tables_.assign(3 * stride_, kOutside);
  ends_.assign(3 * stride_, 0);
  directions_.assign(3 * static_cast<std::size_t>(blocks_), 0);
  row_edges_ = plan.row_edges;
  for (std::size_t cell = 0; cell < 3; ++cell) {
    fillCell(plan, static_cast<int>(cell));
    const auto paths = [&](std::size_t of) { return plan.paths.data() + 3 * of; };
    alike_[cell] = 0;
    while (!std::equal(paths(cell), paths(cell) + 3, paths(alike_[cell]))) ++alike_[cell];
  }
}

std::size_t PixelKinds::cellOfRow(int v) const { return cellOf(row_edges_, v); }

void PixelKinds::fillCell(const PathPlan& plan, int cell) {
  const int width = plan.column_edges[3];
  std::uint8_t* kinds = tables_.data() + cell * stride_ + kPathMargin;
  std::uint8_t* most = directions_.data() + cell * static_cast<std::size_t>(blocks_);
  for (int u = 0; u < width; ++u) {
    const int paths = plan.paths[3 * cell + cellOf(plan.column_edges, u)];
    kinds[u] = kindOf(paths);
    for (const int step : {u, u + kLargestLag}) {
      std::uint8_t& of_block = most[step / kPenaltyBlock];
      of_block = std::max(of_block, static_cast<std::uint8_t>(paths / 2));
    }
  }
  int* ends = ends_.data() + cell * stride_ + kPathMargin;
  int next = width + kPathMargin;
  for (int u = width + kPathMargin - 1; u >= -kPathMargin; --u) {
    if (u + 1 < width + kPathMargin && kinds[u] != kinds[u + 1]) next = u + 1;
    ends[u] = next;
  }
}

}  // namespace adaptive_grid_stereo
