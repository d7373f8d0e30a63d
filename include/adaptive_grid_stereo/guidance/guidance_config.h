#ifndef ADAPTIVE_GRID_STEREO_GUIDANCE_GUIDANCE_CONFIG_H
#define ADAPTIVE_GRID_STEREO_GUIDANCE_GUIDANCE_CONFIG_H

#include <string>
#include <vector>

namespace adaptive_grid_stereo {

/// Parameters of the flight state (eq. 1), the grid (eq. 5) and the path plan, with the package's
/// defaults: those of a small fixed wing.
struct GuidanceConfig {
  /// Up to this forward speed the aircraft counts as standing [m/s], 0..100.
  double lock_speed = 0.5;
  /// V_max, Y_max, P_max of eq. 1 and 5: 0.1..1000 [m/s], 0.01..100 [rad/s], 0.01..100 [rad/s].
  double max_speed = 20.0;
  double max_yaw_rate = 1.0;
  double max_pitch_rate = 0.8;
  /// Share of the largest rate from which YAW and PITCH begin [1], 0..1.
  double sigma1 = 0.3;
  double sigma2 = 0.3;
  /// A state is left only below hysteresis * its threshold [1], 0..1.
  double hysteresis = 0.8;
  /// A state is held at least so long once entered [s], 0..10; 0: no minimum.
  double min_dwell_time = 0.0;
  /// g of eq. 5 as w = W - g * (v / V_max) * W [1], 0..100.
  double grid_gain = 2.0;
  /// Smallest centre cell as a share of the image's width and height [1], 0..1.
  double center_min_fraction = 1.0 / 3.0;
  /// The ladder: paths at distance 0, 1 and 2 from the focus, each 4, 8 or 16, never increasing.
  int paths_focus = 16;
  int paths_near = 8;
  int paths_far = 4;
  /// Paths everywhere while the motion is unknown or stale, 4, 8 or 16.
  int paths_unknown = 8;

  /// Brings every value into its legal range (NaN becomes the default, other numbers of paths the
  /// next lower legal one) and returns one sentence per value that was changed.
  std::vector<std::string> validate();
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_GUIDANCE_GUIDANCE_CONFIG_H
