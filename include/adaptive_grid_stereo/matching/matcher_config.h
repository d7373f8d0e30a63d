#ifndef ADAPTIVE_GRID_STEREO_MATCHING_MATCHER_CONFIG_H
#define ADAPTIVE_GRID_STEREO_MATCHING_MATCHER_CONFIG_H

#include <string>
#include <vector>

namespace adaptive_grid_stereo {

/// Census windows, width x height [px]; the value is the number of bits of the census string.
enum class CensusWindow { k5x5 = 24, k7x7 = 48, k9x7 = 62 };

/// One of kCensusWindowNames.
const char* toString(CensusWindow window);
constexpr char kCensusWindowNames[] = "5x5, 7x7 or 9x7";

/// The window of that name; throws std::invalid_argument, listing the legal names, for any other.
CensusWindow censusWindowFromString(const std::string& name);

/// Fractional bits of the fixed-point disparity; one step is 1/16 px.
constexpr int kDisparityShift = 4;
constexpr int kDisparityScale = 1 << kDisparityShift;

/// Path costs live in 8 bits: largest Hamming distance (62) + largest P2 must not exceed 255, and
/// the sums of one sweep share 16 bits with the matching cost (10 + 6 bits), which asks for P2 <=
/// 127.
constexpr int kLargestPenalty = 127;

/// Every matching parameter, with the package's defaults. The .cfg, the YAML files and the README's
/// table repeat them, and a test compares those with this struct.
struct MatcherConfig {
  /// Smallest disparity searched [px], -1024..1024.
  int min_disparity = 0;
  /// Number of disparities searched [px], 16..512, a multiple of 16.
  int disparity_range = 64;
  CensusWindow census_window = CensusWindow::k9x7;
  /// P1 of eq. 6: penalty for a change of disparity by one pixel [Hamming bits],
  /// 0..kLargestPenalty-1.
  int penalty_small = 16;
  /// P2' of eq. 7: penalty for larger changes before it is divided by the grey-level step
  /// [Hamming bits], 1..2000. The quotient is limited to [penalty_large_min, kLargestPenalty].
  int penalty_large = 1400;
  /// Lower limit of P2 [Hamming bits], > penalty_small, <= kLargestPenalty.
  int penalty_large_min = 22;
  /// Divide P2' by the grey-level step (eq. 7); otherwise P2 = min(P2', kLargestPenalty).
  bool adaptive_penalty = true;
  /// The winner's sum must be this much smaller than any other's that is not its neighbour [%],
  /// 0..99; 0: no check.
  double uniqueness_ratio = 0.0;
  /// Largest difference between the left and the right disparity [px]; negative: no check.
  int disp12_max_diff = 2;
  /// Pixels whose surroundings vary less are invalid: standard deviation in the census window [grey
  /// levels], 0..100; 0: no check. Keeps false depth out of open sky, at the price of bare walls.
  double min_contrast = 0.0;
  /// Connected regions of at most so many pixels are removed [px]; 0: no removal.
  int speckle_size = 100;
  /// Neighbours belong to one region if their disparities differ by at most this [px].
  int speckle_range = 3;
  /// Quadratic sub-pixel interpolation.
  bool subpixel = true;
  /// 3x3 median of the valid disparities.
  bool median_filter = true;
  /// Worker threads; 0: as many as the machine has cores.
  int threads = 0;

  /// Brings every value into its legal range and returns one sentence per value that was changed
  /// (name, value found, value used, reason). After it the config is accepted by StereoMatcher.
  std::vector<std::string> validate();
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_MATCHING_MATCHER_CONFIG_H
