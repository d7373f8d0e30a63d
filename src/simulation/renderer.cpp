#include "adaptive_grid_stereo/simulation/renderer.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <thread>
#include <vector>

#include "adaptive_grid_stereo/simulation/noise.h"
#include "adaptive_grid_stereo/simulation/texture.h"

namespace adaptive_grid_stereo {
namespace simulation {
namespace {

// Low afternoon sun, behind and left of the take-off direction.
const Eigen::Vector3f kSunDirection = Eigen::Vector3f(-0.45f, 0.50f, 0.74f).normalized();
constexpr float kSunLight = 1.15f;
constexpr float kSkyLight = 0.62f;
constexpr float kHazeDistance = 1300.0f;  // [m]
constexpr float kShadowReach = 60.0f;     // [m]

// Runs work(0) .. work(count - 1) on `threads` threads.
template <typename Work>
void parallelRows(int count, int threads, const Work& work) {
  if (threads <= 0) threads = std::max(1u, std::thread::hardware_concurrency());
  std::atomic<int> next{0};
  const auto run = [&] {
    for (int i = next++; i < count; i = next++) work(i);
  };
  std::vector<std::thread> helpers;
  for (int i = 1; i < threads; ++i) helpers.emplace_back(run);
  run();
  for (std::thread& helper : helpers) helper.join();
}

// Points of the R2 sequence (Roberts 2018), which fill the unit square evenly.
Eigen::Vector2f evenPoint(int index) {
  constexpr double kPlastic = 1.32471795724474602596;
  const double u = 0.5 + index / kPlastic;
  const double v = 0.5 + index / (kPlastic * kPlastic);
  return {static_cast<float>(u - std::floor(u)), static_cast<float>(v - std::floor(v))};
}

}  // namespace

Eigen::Quaterniond StereoRig::bodyFromOptical() {
  Eigen::Matrix3d axes;
  axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return Eigen::Quaterniond(axes);
}

struct Renderer::Pose {
  Eigen::Matrix3f world_from_optical;
  Eigen::Vector3f left;
  Eigen::Vector3f right;
};

Renderer::Pose Renderer::poseAt(const Trajectory& flight, double time) const {
  const FlightSample sample = flight.at(time);
  Pose pose;
  pose.world_from_optical =
      (sample.attitude * StereoRig::bodyFromOptical()).toRotationMatrix().cast<float>();
  pose.left = (sample.position + sample.attitude * config_.rig.leftPosition()).cast<float>();
  pose.right = (sample.position + sample.attitude * config_.rig.rightPosition()).cast<float>();
  return pose;
}

float Renderer::sumOfLight(const RayBundle& rays) const {
  const auto pixel_angle = static_cast<float>(1.0 / config_.rig.focal);
  std::array<SurfacePoint, RayBundle::kSize> points;
  std::array<bool, RayBundle::kSize> hits;
  scene_.intersect(rays, &points, &hits);

  RayBundle shadow_rays;
  std::array<int, RayBundle::kSize> shadow_index;
  for (int i = 0; i < rays.count; ++i) {
    if (!hits[i] || points[i].normal.dot(kSunDirection) <= 0.0f) continue;
    shadow_index[shadow_rays.count] = i;
    shadow_rays.add(points[i].position + 0.03f * points[i].normal, kSunDirection);
  }
  std::array<bool, RayBundle::kSize> sunny{};
  std::array<bool, RayBundle::kSize> shaded;
  if (shadow_rays.count > 0) scene_.occluded(shadow_rays, kShadowReach, &shaded);
  for (int i = 0; i < shadow_rays.count; ++i) sunny[shadow_index[i]] = !shaded[i];

  float sum = 0.0f;
  for (int i = 0; i < rays.count; ++i) {
    if (!hits[i]) {
      sum += skyBrightness(rays.directions[i], pixel_angle);
      continue;
    }
    const SurfacePoint& point = points[i];
    // A pixel's width on the surface: larger at grazing angles, though only one way, hence the
    // root.
    const float facing = std::max(0.02f, -rays.directions[i].dot(point.normal));
    const float footprint = point.distance * pixel_angle / std::sqrt(facing);
    const float sun = sunny[i] ? kSunLight * point.normal.dot(kSunDirection) : 0.0f;
    const float sky = kSkyLight * (0.75f + 0.25f * point.normal.z());
    const float lit = (sun + sky) * albedo(point.material, point.position, point.normal, footprint);
    const float clearness = std::exp(-point.distance / kHazeDistance);
    sum += kHazeBrightness + clearness * (lit - kHazeBrightness);
  }
  return sum;
}

void Renderer::renderRow(const Pose* poses, bool right, int row, std::uint64_t index,
                         cv::Mat* image) const {
  const StereoRig& rig = config_.rig;
  const std::uint64_t stream = 4 * index + (right ? 1 : 0);
  const double gain = right ? config_.right_gain : 1.0;
  auto* pixels = image->ptr<unsigned char>(row);
  for (int column = 0; column < rig.width; ++column) {
    const std::uint64_t pixel = static_cast<std::uint64_t>(row) * rig.width + column;
    const std::uint64_t bits = hashBits(config_.seed + 1, stream, pixel);
    const auto shift_u = static_cast<float>((bits >> 40) * 0x1.0p-24);
    const auto shift_v = static_cast<float>((bits & 0xffffff) * 0x1.0p-24);
    float sum = 0.0f;
    RayBundle rays;
    for (int i = 0; i < config_.samples; ++i) {
      const Eigen::Vector2f even = evenPoint(i);
      const float u = even.x() + shift_u - std::floor(even.x() + shift_u) - 0.5f;
      const float v = even.y() + shift_v - std::floor(even.y() + shift_v) - 0.5f;
      const Eigen::Vector3f ray(static_cast<float>((column + u - rig.cx()) / rig.focal),
                                static_cast<float>((row + v - rig.cy()) / rig.focal), 1.0f);
      const Pose& pose = poses[i];
      rays.add(right ? pose.right : pose.left, (pose.world_from_optical * ray).normalized());
      if (rays.count == RayBundle::kSize || i + 1 == config_.samples) {
        sum += sumOfLight(rays);
        rays.count = 0;
      }
    }
    const double light = gain * sum / config_.samples;
    // Shot noise grows with the root of the light, on top of a constant read noise.
    const double sigma = config_.noise * std::sqrt(0.3 + 1.4 * std::max(0.0, light));
    const double grey = 255.0 * light + sigma * gaussianRandom(config_.seed + 2, stream, pixel);
    pixels[column] = static_cast<unsigned char>(std::min(255.0, std::max(0.0, grey + 0.5)));
  }
}

void Renderer::traceTruthRow(const Pose& pose, int row, StereoFrame* frame) const {
  const StereoRig& rig = config_.rig;
  auto* disparity = frame->disparity.ptr<float>(row);
  auto* occlusion = frame->occlusion.ptr<unsigned char>(row);
  for (int column = 0; column < rig.width; ++column) {
    // The ray's z is 1, so the distance along it is the depth.
    const Eigen::Vector3f ray(static_cast<float>((column - rig.cx()) / rig.focal),
                              static_cast<float>((row - rig.cy()) / rig.focal), 1.0f);
    SurfacePoint point;
    const bool hit = scene_.intersect(pose.left, pose.world_from_optical * ray, &point);
    disparity[column] = hit ? static_cast<float>(rig.focal * rig.baseline / point.distance) : 0.0f;
    occlusion[column] = kVisible;
    if (column - disparity[column] < -0.5f) {
      occlusion[column] = kOutOfView;
      continue;
    }
    const Eigen::Vector3f to_right = hit ? Eigen::Vector3f(point.position - pose.right)
                                         : Eigen::Vector3f(pose.world_from_optical * ray * 1e5f);
    const float far = 1.0f - std::max(2e-3f, 0.02f / to_right.norm());
    if (scene_.occluded(pose.right, to_right, 0.0f, far)) occlusion[column] = kOccluded;
  }
}

StereoFrame Renderer::render(const Trajectory& flight, double time, std::uint64_t index) const {
  const StereoRig& rig = config_.rig;
  StereoFrame frame;
  frame.left.create(rig.height, rig.width, CV_8UC1);
  frame.right.create(rig.height, rig.width, CV_8UC1);
  frame.disparity.create(rig.height, rig.width, CV_32FC1);
  frame.occlusion.create(rig.height, rig.width, CV_8UC1);

  // Each ray of a pixel sees another instant of the exposure.
  std::vector<Pose> poses;
  for (int i = 0; i < config_.samples; ++i) {
    const double share = (i + 0.5) / config_.samples - 0.5;
    poses.push_back(poseAt(flight, time + share * config_.exposure_time));
  }
  const Pose center = poseAt(flight, time);
  parallelRows(rig.height, config_.threads, [&](int row) {
    renderRow(poses.data(), false, row, index, &frame.left);
    renderRow(poses.data(), true, row, index, &frame.right);
    traceTruthRow(center, row, &frame);
  });
  return frame;
}

}  // namespace simulation
}  // namespace adaptive_grid_stereo
