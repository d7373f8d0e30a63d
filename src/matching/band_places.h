#ifndef ADAPTIVE_GRID_STEREO_SRC_MATCHING_BAND_PLACES_H
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_BAND_PLACES_H

#include <cstddef>
#include <cstdint>
#include <vector>

#include "src/matching/path_rows.h"
#include "src/matching/sweep.h"

namespace adaptive_grid_stereo {

/// The places of a band's path costs, by steps.
class BandPlaces {
 public:
  /// Those that steps [begin, end) of a band need. zero: place of path costs that are all zero.
  /// Remembers its answers, since most bands are alike. The result is valid until the next call.
  PathPlaces find(const BandPathRows& rows, int begin, int end, int width, std::uint8_t* zero);

  /// Forgets all answers. Must be called where tables of places or kinds have changed.
  void forget();

 private:
  /// As paths of one kind see the rows; kOutside: as they are, whatever their kinds.
  struct Table {
    BandPathRows rows;
    int begin, end;
    PixelKind kind;
    std::vector<std::uint8_t*> places;
  };
  struct Answer {
    BandPathRows rows;
    int begin, end;
    PathPlaces places;
  };

  StepPlaces findTable(const Table& wanted, int width, std::uint8_t* zero);

  std::vector<Table> tables_;
  std::vector<Answer> answers_;
  std::size_t last_ = 0;  // the latest of them
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_BAND_PLACES_H
