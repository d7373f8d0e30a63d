#ifndef ADAPTIVE_GRID_STEREO_SIMULATION_RENDERER_H
#define ADAPTIVE_GRID_STEREO_SIMULATION_RENDERER_H

#include <cstdint>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "adaptive_grid_stereo/simulation/scene.h"
#include "adaptive_grid_stereo/simulation/trajectory.h"

namespace adaptive_grid_stereo {
namespace simulation {

/// Two ideal pinhole cameras, side by side, looking along the body's forward axis. Pixel (u, v) is
/// centred at integer coordinates; the principal point is the image's centre.
struct StereoRig {
  int width = 256;             // [px]
  int height = 144;            // [px]
  double focal = 200.0;        // [px]
  double baseline = 0.8;       // [m]
  double mount_forward = 0.3;  // cameras before the body's origin [m]

  double cx() const { return 0.5 * (width - 1); }
  double cy() const { return 0.5 * (height - 1); }
  /// Position of the left (right) camera in the body frame (FLU) [m].
  Eigen::Vector3d leftPosition() const { return {mount_forward, 0.5 * baseline, 0.0}; }
  Eigen::Vector3d rightPosition() const { return {mount_forward, -0.5 * baseline, 0.0}; }
  /// Rotates optical axes (x right, y down, z forward) into body axes (x forward, y left, z up).
  static Eigen::Quaterniond bodyFromOptical();
};

struct RendererConfig {
  StereoRig rig;
  int samples = 8;             // rays a pixel, >= 1
  double exposure_time = 0.0;  // motion blur over so long, centred on the stamp [s]
  double right_gain = 1.0;     // exposure of the right camera against the left
  double noise = 1.5;          // of a mid-grey pixel, standard deviation [grey levels]
  std::uint64_t seed = 1;
  int threads = 0;  // 0: one per processor
};

/// Values of StereoFrame::occlusion.
constexpr unsigned char kVisible = 0;
constexpr unsigned char kOutOfView = 128;  // outside the right image
constexpr unsigned char kOccluded = 255;   // hidden from the right camera

/// What the rig sees at one instant, and the truth about it.
struct StereoFrame {
  cv::Mat left;       // CV_8UC1
  cv::Mat right;      // CV_8UC1
  cv::Mat disparity;  // CV_32FC1, left view, x_left - x_right [px] along each pixel's centre ray;
                      // 0: sky
  cv::Mat occlusion;  // CV_8UC1, left view
};

/// Renders a scene from a rig that flies. Uses its own threads; the result depends neither on their
/// number nor on the frames rendered before.
class Renderer {
 public:
  Renderer(const Scene& scene, const RendererConfig& config) : scene_(scene), config_(config) {}

  /// The frame at `time` [s] of the flight; `index` distinguishes the noise of frames.
  StereoFrame render(const Trajectory& flight, double time, std::uint64_t index) const;

 private:
  struct Pose;
  Pose poseAt(const Trajectory& flight, double time) const;
  float sumOfLight(const RayBundle& rays) const;
  void renderRow(const Pose* poses, bool right, int row, std::uint64_t index, cv::Mat* image) const;
  void traceTruthRow(const Pose& pose, int row, StereoFrame* frame) const;

  const Scene& scene_;
  RendererConfig config_;
};

}  // namespace simulation
}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SIMULATION_RENDERER_H
