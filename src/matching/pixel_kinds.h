#ifndef ADAPTIVE_GRID_STEREO_SRC_MATCHING_PIXEL_KINDS_H
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_PIXEL_KINDS_H

#include <array>
#include <cstdint>
#include <vector>

#include "adaptive_grid_stereo/path_plan.h"
#include "src/matching/sweep.h"

namespace adaptive_grid_stereo {

/// The plan turned by 180 degrees, as the upward sweep sees it.
PathPlan turned(const PathPlan& plan);

/// The PixelKind of every pixel of a sweep, from the path plan. The rows of one row of cells share
/// one table, as do rows of cells that are alike.
class PixelKinds {
 public:
  /// For the upward sweep the plan is turned by 180 degrees.
  void assign(const PathPlan& plan, bool upward);

  /// The row of cells that row v belongs to: 0, 1 or 2.
  std::size_t cellOfRow(int v) const;

  /// Kinds of a row of cells' pixels at [u], -kPathMargin .. width + kPathMargin - 1.
  const std::uint8_t* ofCells(std::size_t cell) const {
    return tables_.data() + alike_[cell] * stride_ + kPathMargin;
  }

  /// The same of row v.
  const std::uint8_t* row(int v) const { return ofCells(cellOfRow(v)); }

  /// For each u of row v the next one of another kind, or of the row's end.
  const int* ends(int v) const { return ends_.data() + cellOfRow(v) * stride_ + kPathMargin; }

  /// Largest number of directions of any pixel that row v, wherever in a band it is, has in each
  /// block of kPenaltyBlock steps: 2, 4 or 8.
  const std::uint8_t* directions(int v) const {
    return directions_.data() + cellOfRow(v) * static_cast<std::size_t>(blocks_);
  }

 private:
  void fillCell(const PathPlan& plan, int cell);

  std::array<int, 4> row_edges_{};
  std::array<std::size_t, 3> alike_{};  // the first row of cells that has the same kinds
  std::size_t stride_ = 0;              // of the tables
  std::vector<std::uint8_t> tables_;
  std::vector<int> ends_;
  int blocks_ = 0;
  std::vector<std::uint8_t> directions_;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_PIXEL_KINDS_H
