#ifndef ADAPTIVE_GRID_STEREO_GUIDANCE_MOTION_ESTIMATOR_H
#define ADAPTIVE_GRID_STEREO_GUIDANCE_MOTION_ESTIMATOR_H

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <Eigen/Geometry>

#include "adaptive_grid_stereo/guidance/motion.h"
#include "adaptive_grid_stereo/guidance/motion_config.h"
#include "adaptive_grid_stereo/guidance/motion_samples.h"
#include "adaptive_grid_stereo/guidance/sample_buffer.h"

namespace adaptive_grid_stereo {

/// How the left optical frame sits on and turns against the frame of a motion source.
struct Mounting {
  /// Rotates a vector of the source's body frame, in MotionConfig::tf_axes, into the left optical
  /// frame.
  Eigen::Quaterniond optical_from_body = Eigen::Quaterniond::Identity();
  /// The same `interval` seconds before, for a camera that turns on the body (a gimbal): its rate
  /// is then that of the camera in the world over the interval. 0: it does not turn.
  Eigen::Quaterniond optical_from_body_before = Eigen::Quaterniond::Identity();
  double interval = 0.0;
  /// In words why the mounting is unknown although it should be known (a gimbal that went silent);
  /// the motion is then invalid.
  std::string error;
};

/// Given the frame of a source and a stamp [s], the camera's mounting; empty if it is not known,
/// and then `camera_rpy` of the config serves.
using MountingLookup =
    std::function<std::optional<Mounting>(const std::string& frame, double stamp)>;

/// State of one source, for diagnostics.
struct SourceReport {
  StampCounts counts;
  std::uint64_t invalid = 0;  // NaN or inf: refused
  double last_stamp = 0.0;    // [s]; 0: none yet
  double period = 0.0;        // [s]; 0: unknown
};
struct EstimatorReport {
  SourceReport imu, odom, gps_vel, gps_fix, mag;
  /// What contradicts the declared axes, in one sentence; empty if nothing does.
  std::string warning;
};

/// Turns samples of any of the sources into forward speed, yaw rate and pitch rate at a stamp.
///
/// "auto" takes the first of odom, gps_vel, gps_fix (speed) and of imu, odom (rates) that is fresh.
/// A source that grows old is faded out over the second half of motion_timeout, one that comes
/// (back) is faded in over as long, so the numbers do not jump when the source changes. Velocities
/// in earth axes are projected on the forward axis with the orientation at their own stamp: that of
/// the odometry's pose for odometry, else that of the Imu messages, else one estimated from gyro,
/// accelerometer and magnetometer; without any the ground speed serves. An Imu whose gravity does
/// not lie along the declared up axis counts as without orientation.
///
/// The estimate for a stamp depends only on the samples, not on the order or the time of their
/// arrival, and uses none that lie more than kInterpolationReach after the stamp. Thread safe:
/// samples may come from several threads while another asks.
class MotionEstimator {
 public:
  explicit MotionEstimator(const MotionConfig& config);
  ~MotionEstimator();

  /// Keeps the samples. Values out of range are corrected as by MotionConfig::validate().
  void setConfig(const MotionConfig& config);

  /// Each returns false, and counts the sample as invalid, if it holds NaN or inf.
  bool add(const OdometrySample& sample);
  bool add(const ImuSample& sample);
  bool add(const VelocitySample& sample);
  bool add(const FixSample& sample);
  bool add(const MagneticSample& sample);

  /// The motion at `stamp` [s] plus the configured delay. Never throws; `mounting` may be empty.
  Motion estimate(double stamp, const MountingLookup& mounting) const;

  /// Whether the sources in use have delivered what counts for `stamp` [s]: the fast ones a sample
  /// at or after it, the slow ones all samples that are due. Silent sources count as ready; after
  /// startOver(), those only that were silent before.
  bool ready(double stamp) const;

  EstimatorReport report() const;

  /// The images' stamps start over at `stamp` [s] (a bag that loops): forgets the samples of
  /// before. Those that belong to the new time may have arrived already, and stay.
  void startOver(double stamp);

  /// Sources from which nothing came since startOver() count as silent from now on.
  void awaitNoLonger();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_GUIDANCE_MOTION_ESTIMATOR_H
