#ifndef ADAPTIVE_GRID_STEREO_SRC_MATCHING_SWEEP_H
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_SWEEP_H

// Data shared by the two sweeps over the image and their caller.
//
// A sweep visits the image row by row and computes, at each pixel, the costs of all paths that come
// from pixels already visited: half of the 16 directions. The upward sweep is the downward one on
// the image turned by 180 degrees, hence its own coordinates: u, v count along the sweep, x, y in
// the image.
//
// Whichever sweep comes to a row first computes the matching costs there and leaves its sums in the
// volume: the row's first pass. The other one adds up and finds the winners: its second pass.

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "adaptive_grid_stereo/matching/census.h"
#include "adaptive_grid_stereo/matching/matcher_config.h"

namespace adaptive_grid_stereo {

/// Rows that a sweep advances together, one behind the other. Their pixels alternate, so that the
/// latency of one row's horizontal path hides behind the others' work, and what the next ones do
/// not need of their path costs stays in the first-level cache.
constexpr int kBandRows = 4;

/// Pixels that a row of a band stays behind the one above it: it needs path costs up to two pixels
/// ahead there, and one step more lets them reach the cache.
constexpr int kBandLag = 3;

/// How far the last row of a band stays behind the first one.
constexpr int kLargestLag = kBandLag * (kBandRows - 1);

/// Pixels without image on either side of a row of path costs.
constexpr int kPathMargin = 2;

/// The sweeps.
enum Sweep { kDown = 0, kUp = 1 };
constexpr int kSweeps = 2;

/// Directions per sweep.
constexpr int kSweepDirections = 8;

/// Bytes before a pixel's path costs, of which the first hold the smallest cost of each direction.
constexpr int kPixelHeader = 64;

/// What a pixel of a sweep needs: to aggregate 2, 4 or 8 directions.
enum PixelKind : std::uint8_t { kOutside = 0, kTwo = 1, kFour = 2, kEight = 3 };

/// Path costs of a pixel: the header, then for each direction a block of padded_range costs.
struct PathLayout {
  int range = 0;
  int padded_range = 0;
  std::size_t pixel_stride = 0;
};

/// Where the path costs of a row's pixels lie: [u], -kPathMargin .. width + kPathMargin - 1. A row
/// inside a band keeps only its last few pixels, so that places recur. Path costs of pixels outside
/// of the image are zero: paths start anew beside them.
using PathRow = std::uint8_t* const*;

/// The rows above a band that its paths come from.
constexpr int kRowsAbove = 2;

/// How many steps before its own a pixel's paths come from: from the second row above, one pixel
/// before.
constexpr int kStepsBack = kRowsAbove * kBandLag + 1;

/// Where the path costs of the pixels lie that a band's rows have at a step: [kPlacesPerStep * step
/// + row]. Rows -1 and -2 are those above the band, as if they went ahead of its first row as rows
/// of a band do. So kernels load the places of a pixel and of all that its paths come from at fixed
/// distances, whatever the row.
using StepPlaces = std::uint8_t* const*;
constexpr int kPlacesPerStep = kRowsAbove + kBandRows;

/// The same as paths of each kind see them: in place of a pixel that does not have such a path,
/// there is one whose path costs are zero, so that paths start anew beside it.
struct PathPlaces {
  StepPlaces all;    // for paths that all pixels have
  StepPlaces four;   // for those of pixels with four or eight directions
  StepPlaces eight;  // with eight
};

/// The winners of a row's pixels, in halves of 16 bits, [x]. What they mean is told apart later, by
/// vectors: for every pixel by itself it would take longer.
struct WinnerRow {
  /// Low: place of the winner's sum of path costs among those of the even or the odd disparities; |
  /// kNotUnique. High: the sum, of a winner only if it is smaller than sumLimit().
  std::uint32_t* found;
  /// The odd disparities' sums before that place (low) and at it (high): those on either side of an
  /// even winner. kNoSum outside of the candidates.
  std::uint32_t* odd;
  /// The even disparities' sums at that place (low) and behind it (high): those on either side of
  /// an odd winner. The winner is even if the first one is its sum.
  std::uint32_t* even;
};
constexpr std::uint32_t kNotUnique = 0x8000;
constexpr std::uint32_t lowHalf(std::uint32_t halves) { return halves & 0xFFFF; }
constexpr std::uint32_t highHalf(std::uint32_t halves) { return halves >> 16; }
constexpr std::uint16_t kNoSum = 0xFFFF;

/// Sums of a pixel with 16 paths (shift 0), 8 (1) or 4 (2) stay below; kNoSum, cut to the bits that
/// a key has for them (keyBits()), does not.
constexpr int sumLimit(int shift) { return 0xFFF >> shift; }
constexpr int kLargestPathCost = static_cast<int>(CensusWindow::k9x7) + kLargestPenalty;
static_assert(16 * kLargestPathCost < sumLimit(0) && 8 * kLargestPathCost < sumLimit(1) &&
                  4 * kLargestPathCost < sumLimit(2),
              "sums must stay below their limits");

/// Where P2 of a row's pixel at a step, for a direction, stands: blocks of steps, direction by
/// direction, so that it is written by vectors and read at fixed distances. The same for all rows
/// of a band.
constexpr int kPenaltyBlock = 64;
constexpr std::size_t penaltyPlace(int step, int direction) {
  constexpr std::size_t kBlock = kPenaltyBlock;
  const std::size_t place = static_cast<std::size_t>(step);
  return (place & ~(kBlock - 1)) * kSweepDirections + (place & (kBlock - 1)) + kBlock * direction;
}

/// Bytes of a census string, whatever the window.
constexpr int kCensusBytes = 8;

/// Bytes of a row's census strings.
constexpr std::size_t censusRowBytes(int width) { return kCensusBytes * censusStride(width); }

/// One row within a band.
struct SweepRow {
  const std::uint8_t* kinds;      // [u], -kPathMargin .. width + kPathMargin - 1
  const int* kind_ends;           // [u] the next column of another kind
  const std::uint8_t* penalties;  // P2 of eq. 7 at [penaltyPlace(step, direction)]
  const std::uint8_t* left;       // census strings of the row, in the target's order
  const std::uint8_t* right;      // mirrored
  std::uint16_t* volume;          // [x * padded_range]
  WinnerRow winners;              // second pass only
};

/// A row of a band as kernels go along it: what belongs to its pixel at a step is found by the step
/// and the image column of the band's first row there, which are the same for all rows of the band.
struct BandRow : SweepRow {
  // Kinds: [step] (kind_ends is as it was). Volume: [column * padded_range]. Winners: [column].
  // Census strings: `left` is that of column 0, `right` that of column 0's first disparity.
  std::ptrdiff_t first_column;  // of column 0's first disparity in the mirrored row
};

/// Neighbouring rows of a band.
struct BandRows {
  const BandRow* rows;
  int count;
  PathPlaces places;  // row 0 is the first of them
};

/// Which way a sweep goes through the image's columns.
struct Course {
  /// The image column of the sweep's column u, and how far it moves while u moves by `steps`.
  std::ptrdiff_t column(std::ptrdiff_t u) const { return (u ^ flip) + origin; }
  std::ptrdiff_t along(std::ptrdiff_t steps) const { return (steps ^ flip) - flip; }

  /// Downwards 0 and 0, upwards -1 and the width.
  std::ptrdiff_t flip = 0, origin = 0;
};

/// Most lanes of any target's byte vectors.
constexpr int kMaxLanes = 64;

/// Vectors of disparities among which one search can find a winner.
constexpr int kSearchBlocks = 16;

/// What all rows of a sweep share.
struct SweepFrame {
  int width = 0;
  int height = 0;
  Course course;
  int min_disparity = 0;
  int penalty_small = 0;
  CensusWindow window = CensusWindow::k9x7;
  /// Of the winner's sum, times 4096, below which a rival makes it ambiguous; 0: no check.
  int uniqueness_factor = 0;
  PathLayout layout;
  /// More disparities than one search for a winner can take.
  bool long_range = false;
  /// 255 where a column is outside of the image, else 0: [column], of any pixel's disparities. The
  /// same if it is mirrored.
  const std::uint8_t* outside = nullptr;
  /// Write the volume past the caches: nobody would find it there in time, or only at the cost of
  /// another thread.
  bool stream_volume = false;
};

/// Lanes of the SIMD target's byte vectors; padded_range must be a multiple.
int sweepLanes();

/// Census strings of row y (censusRow()), in the order that the target's costs want: `row` receives
/// censusRowBytes(width) bytes. `planes` is room for as many.
void orderedCensusRow(const PaddedImage& image, bool mirrored, int y, CensusWindow window,
                      std::uint8_t* planes, std::uint8_t* row);

/// Rows of a band whose pixels at a step are inside of the image: first .. last - 1.
struct ActiveRows {
  int first, last;
  int count() const { return last - first; }
};
inline ActiveRows findActiveRows(int width, int row_count, int step) {
  return {std::max(0, (step - width + kBandLag) / kBandLag),
          std::min(row_count, (step + kBandLag) / kBandLag)};
}

/// Steps [begin, end) of a band: which rows have pixels there, whether these are all of one kind,
/// which one, and whether the disparities of all of them stay inside the right image. If they are
/// of several kinds, the rows need not be the same at all steps.
struct StepRun {
  int begin, end;
  ActiveRows rows;
  bool uniform, inner;
  int kind;
};

/// Run steps of one band of `row_count` <= kBandRows rows. At step s row r is at pixel
/// s - kBandLag * r; the band is complete with steps 0 to width + kBandLag * (row_count - 1).
void runFirstPass(const SweepFrame& frame, const SweepRow* rows, int row_count,
                  const PathPlaces& places, const StepRun* runs, std::size_t run_count);
void runSecondPass(const SweepFrame& frame, const SweepRow* rows, int row_count,
                   const PathPlaces& places, const StepRun* runs, std::size_t run_count);

/// P2 of eq. 7 for a row's pixels at steps [begin, end) and each direction:
/// penalties[penaltyPlace(s, r)] is the entry of `table` (256, falling) for the difference of the
/// grey levels current[s] and previous[r][s]. Of each block of kPenaltyBlock steps only the first
/// `directions` (2, 4 or 8) are needed. `begin` must be a block's. May write up to a vector's
/// pixels beyond `end`, and read as many.
void penaltyRow(const std::uint8_t* current, const std::uint8_t* const* previous,
                const std::uint8_t* directions, int begin, int end, const std::uint8_t* table,
                std::uint8_t* penalties);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_SWEEP_H
