#ifndef ADAPTIVE_GRID_STEREO_SRC_GUIDANCE_MOTION_SOURCES_H
#define ADAPTIVE_GRID_STEREO_SRC_GUIDANCE_MOTION_SOURCES_H

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "adaptive_grid_stereo/guidance/attitude_filter.h"
#include "adaptive_grid_stereo/guidance/motion_config.h"
#include "adaptive_grid_stereo/guidance/motion_samples.h"
#include "adaptive_grid_stereo/guidance/sample_buffer.h"

namespace adaptive_grid_stereo {

/// The samples of all sources, and what each source alone says at an instant. Not thread safe.
class MotionSources {
 public:
  /// What one source says, and how much it counts against those after it in the order.
  template <typename Value>
  struct Opinion {
    const char* source = "";
    Value value;
    double age = 0.0;     // of its newest sample [s]
    double weight = 0.0;  // 0..1
  };
  using Speed = Opinion<double>;          // [m/s]
  using Rate = Opinion<Eigen::Vector3d>;  // in rate_axes [rad/s]; and the frame:
  struct FramedRate {
    Rate rate;
    std::string frame;
  };

  /// What the fresh sources that the config allows say at `time` [s], best first.
  std::vector<Speed> speeds(double time, const MotionConfig& config);
  std::vector<FramedRate> rates(double time, const MotionConfig& config) const;

  /// How the body of that rate source turned from one time to another [s], by its samples converted
  /// to `axes`: the rotation from its later to its earlier axes.
  Eigen::Quaterniond turn(const std::string& source, double from, double to, RateAxes axes,
                          const MotionConfig& config) const;

  bool ready(double time, const MotionConfig& config) const;

  /// False if the mean acceleration of the last seconds is more than 60 degrees off the body's up
  /// axis: the Imu is not mounted as declared, so its orientation is not the body's.
  bool imuIsUpright(double time, RateAxes axes) const;

  /// SampleBuffer::startOver() for every source.
  void startOver(double stamp);
  void awaitNoLonger();

  SampleBuffer<ImuSample> imu{8192};
  SampleBuffer<OdometrySample> odom{4096};
  SampleBuffer<VelocitySample> gps_vel{512};
  SampleBuffer<FixSample> gps_fix{512};
  SampleBuffer<MagneticSample> mag{2048};
  AttitudeTrack attitude;

 private:
  /// Forward axis of the body in ENU by the Imu, given or estimated; empty if neither is at hand.
  std::optional<Eigen::Vector3d> forwardAxisAt(double time, const MotionConfig& config);
  std::optional<AttitudeInput> attitudeInput(const ImuSample& sample, const MotionConfig& config);
  double projected(const Eigen::Vector3d& velocity_enu, double time, const MotionConfig& config);
  double speedOf(const OdometrySample& sample, const MotionConfig& config);
  double speedOf(const VelocitySample& sample, const MotionConfig& config);
  double gpsSpeed(double time, const MotionConfig& config);
  double odometrySpeed(double time, const MotionConfig& config);
};

/// Axes in which gps/vel comes.
VelocityAxes gpsVelocityAxes(const MotionConfig& config);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SRC_GUIDANCE_MOTION_SOURCES_H
