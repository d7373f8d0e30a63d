#ifndef ADAPTIVE_GRID_STEREO_SRC_MATCHING_BANDS_H
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_BANDS_H

#include <algorithm>

#include "src/matching/sweep.h"

namespace adaptive_grid_stereo {

/// Where strips take turns with the places near their border, so that one does not write over what
/// the other still reads: a band's turn, and that of the one above. They differ by one, or not at
/// all where one thread does all of the band, once the one above is finished.
struct BandTurns {
  int own, above;
};

/// The bands of a sweep, counted along it. Those of both sweeps are made of the same rows of the
/// image: the band with fewer of them, if there is one, is the last downwards and the first
/// upwards.
class Bands {
 public:
  Bands() = default;
  Bands(int height, bool upward) : height_(height), upward_(upward) {}

  int count() const { return (height_ + kBandRows - 1) / kBandRows; }
  /// The same rows' band in the other sweep.
  int opposite(int band) const { return count() - 1 - band; }

  /// First row of a band, along the sweep, and how many it has.
  int firstRow(int band) const { return std::max(0, kBandRows * band - missing()); }
  int rows(int band) const {
    return std::min(height_, kBandRows * (band + 1) - missing()) - firstRow(band);
  }

  /// First row of a band in the image.
  int imageRow(int band) const { return kBandRows * (upward_ ? opposite(band) : band); }

 private:
  // Rows that an upward sweep's first band lacks.
  int missing() const { return upward_ ? kBandRows * count() - height_ : 0; }

  int height_ = 0;
  bool upward_ = false;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_BANDS_H
