#ifndef ADAPTIVE_GRID_STEREO_TOOLS_EVALUATION_SUMMARY_H
#define ADAPTIVE_GRID_STEREO_TOOLS_EVALUATION_SUMMARY_H

#include <string>
#include <utility>
#include <vector>

#include "evaluation.h"

namespace adaptive_grid_stereo {

/// The figures of one method, on a scene or on the mean over several; no images.
struct MethodSummary {
  Method method;
  double mean_paths = 0.0;  // per pixel; 0 for peers
  PathPlan plan;            // of ours, on a scene
  RegionScores whole;
  RegionScores in_focus;
  RegionScores uniform_in_focus;
  double time_ms = 0.0;                                // median over the rounds
  std::vector<double> rounds_ms;                       // of a scene, in the order of running
  std::vector<std::pair<std::string, double>> ratios;  // this method's time to each peer's
};

struct SceneSummary {
  std::string set;     // e.g. "Middlebury 2003"
  std::string family;  // over which means are taken, e.g. "Middlebury"
  std::string name;
  std::string left;  // path of the left image
  int width = 0;
  int height = 0;
  int disparity_range = 0;
  std::vector<MethodSummary> methods;
};

struct FamilySummary {
  std::string family;
  int scenes = 0;
  std::vector<MethodSummary> methods;
};

SceneSummary summarise(const SceneResult& result);

/// The means over the scenes of each family: errors and times arithmetically, each scene counting
/// the same and those without truth left out of the errors; ratios of times geometrically. All
/// scenes must have been run with the same methods.
std::vector<FamilySummary> familyMeans(const std::vector<SceneSummary>& scenes);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_TOOLS_EVALUATION_SUMMARY_H
