#ifndef ADAPTIVE_GRID_STEREO_SRC_MATCHING_BAND_PLACES_H
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_BAND_PLACES_H

#include <array>
#include <cstdint>
#include <vector>

#include "src/matching/sweep.h"

namespace adaptive_grid_stereo {

/// The places of a band's path costs, by steps.
class BandPlaces {
 public:
  /// Those of a band's rows, and of the row above the first one. Remembers a few tables, since most
  /// bands have the same. The result is valid until the next call.
  StepPlaces find(const SweepRow* rows, int row_count, int width);

  /// Forgets all tables. Must be called where those of the rows (PathRow) have changed.
  void forget() { tables_.clear(); }

 private:
  struct Table {
    std::array<PathRow, kPlacesPerStep> rows{};
    std::vector<std::uint8_t*> places;
  };

  std::vector<Table> tables_;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_BAND_PLACES_H
