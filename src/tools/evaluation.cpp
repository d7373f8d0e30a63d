#include "evaluation.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <map>
#include <memory>
#include <sstream>
#include <stdexcept>

#include "adaptive_grid_stereo/matching/stereo_matcher.h"

namespace adaptive_grid_stereo {
namespace {

Method uniformMethod(int paths) {
  Method method;
  method.name = "uniform " + std::to_string(paths);
  method.uniform_paths = paths;
  return method;
}

Method motionMethod(const std::string& name, double speed, double yaw_rate, double pitch_rate) {
  Method method;
  method.name = name;
  method.motion = {speed, yaw_rate, pitch_rate};
  return method;
}

cv::Mat infForInvalid(const MatchResult& result) {
  cv::Mat disparity = toFloatDisparity(result);
  for (float& value : cv::Mat_<float>(disparity)) {
    if (value < static_cast<float>(result.min_disparity)) {
      value = std::numeric_limits<float>::infinity();
    }
  }
  return disparity;
}

double elapsedMs(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

RegionScores scoreRegions(const cv::Mat& disparity, const LoadedScene& images,
                          const cv::Rect& box) {
  RegionScores scores;
  if (!images.visible.empty()) {
    scores.visible = score(disparity, images.truth, images.visible, box);
  }
  if (!images.all.empty()) scores.all = score(disparity, images.truth, images.all, box);
  return scores;
}

void scoreMethods(SceneResult* result) {
  const cv::Rect whole(cv::Point(0, 0), result->images.left.size());
  const auto uniform =
      std::find_if(result->methods.begin(), result->methods.end(),
                   [](const MethodResult& m) { return m.method.uniform_paths == 16; });
  for (MethodResult& method : result->methods) {
    method.whole = scoreRegions(method.disparity, result->images, whole);
    if (method.method.is_peer || method.method.uniform_paths != 0) continue;
    method.focus = focusOf(method.plan);
    method.in_focus = scoreRegions(method.disparity, result->images, method.focus);
    if (uniform != result->methods.end()) {
      method.uniform_in_focus = scoreRegions(uniform->disparity, result->images, method.focus);
    }
  }
}

}  // namespace

std::vector<Method> defaultMethods(const GuidanceConfig& guidance,
                                   const std::vector<double>& speeds, double turn_speed) {
  std::vector<Method> methods{uniformMethod(16), uniformMethod(8), uniformMethod(4)};
  for (const double speed : speeds) {
    std::ostringstream name;
    name.precision(3);
    name << "forward " << speed << " m/s";
    methods.push_back(motionMethod(name.str(), speed, 0.0, 0.0));
  }
  const double yaw = guidance.max_yaw_rate;
  const double pitch = guidance.max_pitch_rate;
  methods.push_back(motionMethod("yaw left", turn_speed, yaw, 0.0));
  methods.push_back(motionMethod("yaw right", turn_speed, -yaw, 0.0));
  methods.push_back(motionMethod("pitch up", turn_speed, 0.0, pitch));
  methods.push_back(motionMethod("pitch down", turn_speed, 0.0, -pitch));
  for (const bool padded : {false, true}) {
    for (const PeerKind kind : kAllPeers) {
      Method method;
      method.name = Peer(kind, padded, 16).name();
      method.is_peer = true;
      method.peer = kind;
      method.padded = padded;
      methods.push_back(method);
    }
  }
  return methods;
}

SceneResult evaluateScene(const Scene& scene, const EvaluationOptions& options,
                          const std::function<void()>& step) {
  SceneResult result;
  result.scene = scene;
  result.images = loadScene(scene);
  const cv::Mat& left = result.images.left;
  const cv::Mat& right = result.images.right;
  if (std::min(left.cols, left.rows) < kMinImageSide) {
    throw std::runtime_error(scene.left + ": is smaller than " + std::to_string(kMinImageSide) +
                             " pixels a side");
  }
  MatcherConfig config = options.matcher;
  if (!options.own_range) config.disparity_range = scene.disparity_range;
  result.disparity_range = config.disparity_range;

  StereoMatcher matcher(config);
  std::map<std::size_t, Peer> peers;
  for (std::size_t i = 0; i < options.methods.size(); ++i) {
    const Method& method = options.methods[i];
    MethodResult one;
    one.method = method;
    if (method.is_peer) {
      peers.emplace(i, Peer(method.peer, method.padded, config.disparity_range));
    } else if (method.uniform_paths != 0) {
      one.plan = uniformPlan(left.cols, left.rows, method.uniform_paths);
    } else {
      one.plan = planForMotion(method.motion, options.guidance, left.size()).plan;
    }
    result.methods.push_back(one);
  }

  for (int round = 0; round < options.repeat; ++round) {
    for (std::size_t i = 0; i < result.methods.size(); ++i) {
      MethodResult& method = result.methods[i];
      const auto start = std::chrono::steady_clock::now();
      if (method.method.is_peer) {
        const cv::Mat& disparity = peers.at(i).match(left, right);
        method.time_ms.push_back(elapsedMs(start));
        if (round == 0) method.disparity = peerToFloat(disparity);
      } else {
        const MatchResult& match = matcher.match(left, right, method.plan);
        method.time_ms.push_back(elapsedMs(start));
        if (round == 0) method.disparity = infForInvalid(match);
      }
      step();
    }
  }
  scoreMethods(&result);
  return result;
}

double medianOf(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

double timeRatio(const MethodResult& a, const MethodResult& b) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < std::min(a.time_ms.size(), b.time_ms.size()); ++i) {
    ratios.push_back(a.time_ms[i] / b.time_ms[i]);
  }
  return medianOf(ratios);
}

}  // namespace adaptive_grid_stereo
