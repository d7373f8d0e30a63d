#ifndef ADAPTIVE_GRID_STEREO_SRC_MATCHING_BAND_PLACES_H
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_BAND_PLACES_H

#include <cstdint>
#include <vector>

#include "src/matching/path_rows.h"
#include "src/matching/sweep.h"

namespace adaptive_grid_stereo {

/// The places of a band's path costs, by steps.
class BandPlaces {
 public:
  /// Those that steps [begin, end) of a band need. zero: place of path costs that are all zero.
  /// Remembers a few answers, since most bands are alike. Valid until answers are forgotten, or
  /// kMostAnswers others have been asked for.
  PathPlaces find(const BandPathRows& rows, int begin, int end, int width, std::uint8_t* zero);

  /// Forgets all answers. Must be called where tables of places or kinds have changed.
  void forget() { answers_.clear(); }

  /// Enough for the sets of places that bands take in turn near borders between strips (BandTurns),
  /// up to eight threads' four strips in each of the three rows of cells: or else each band would
  /// make its own.
  static constexpr std::size_t kMostAnswers = 64;

 private:
  struct Answer {
    BandPathRows rows;
    int begin, end;
    // Empty if they would not differ from the first one, or if no pixel has such paths.
    std::vector<std::uint8_t*> all, four, eight;
    PathPlaces places;
  };

  std::vector<Answer> answers_;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_BAND_PLACES_H
