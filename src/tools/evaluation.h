#ifndef ADAPTIVE_GRID_STEREO_TOOLS_EVALUATION_H
#define ADAPTIVE_GRID_STEREO_TOOLS_EVALUATION_H

#include <functional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "adaptive_grid_stereo/guidance/guidance_config.h"
#include "adaptive_grid_stereo/matching/matcher_config.h"
#include "adaptive_grid_stereo/path_plan.h"
#include "dataset.h"
#include "motion_plan.h"
#include "peers.h"
#include "score.h"

namespace adaptive_grid_stereo {

/// One way to match: ours with a plan, or one of OpenCV's matchers.
struct Method {
  std::string name;
  bool is_peer = false;
  PeerKind peer = PeerKind::kBm;  // of a peer
  bool padded = false;            // of a peer
  int uniform_paths = 0;          // of ours: 16, 8 or 4 everywhere, or 0: the plan for `motion`
  PlannedMotion motion;
};

/// The methods that `evaluate` compares by default: uniform 16, 8, 4; forward at each of `speeds`
/// [m/s]; turns in the four directions at turn_speed [m/s] and the largest rates; every peer, as it
/// is and padded.
std::vector<Method> defaultMethods(const GuidanceConfig& guidance,
                                   const std::vector<double>& speeds, double turn_speed);

struct EvaluationOptions {
  MatcherConfig matcher;
  bool own_range = false;  // true: matcher.disparity_range for every scene, not the set's
  GuidanceConfig guidance;
  std::vector<Method> methods;
  int repeat = 5;
};

/// Error over the pixels that both images see, and over all; without pixels where the set has none.
struct RegionScores {
  Score visible;
  Score all;
};

struct MethodResult {
  Method method;
  PathPlan plan;                // of ours
  cv::Mat disparity;            // CV_32FC1 [px], inf = invalid
  std::vector<double> time_ms;  // of each round
  RegionScores whole;
  cv::Rect focus;                 // of an adaptive plan; empty otherwise
  RegionScores in_focus;          // inside that box
  RegionScores uniform_in_focus;  // uniform 16 inside the same box, where it ran, too
};

struct SceneResult {
  Scene scene;
  LoadedScene images;
  int disparity_range = 0;  // that was searched
  std::vector<MethodResult> methods;
};

/// Runs every method on a scene, `repeat` rounds in which all of them take turns, so that a machine
/// that is slower for a while is so for all; `step` is called after each run.
/// Throws std::runtime_error if the scene's files are damaged or too small.
SceneResult evaluateScene(const Scene& scene, const EvaluationOptions& options,
                          const std::function<void()>& step);

double medianOf(std::vector<double> values);

/// Median over the rounds of a's time divided by b's.
double timeRatio(const MethodResult& a, const MethodResult& b);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_TOOLS_EVALUATION_H
