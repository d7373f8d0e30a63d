#include "evaluation_summary.h"

#include <algorithm>
#include <cmath>

namespace adaptive_grid_stereo {
namespace {

using Scenes = std::vector<const SceneSummary*>;

RegionScores meanRegions(const Scenes& scenes, std::size_t method,
                         RegionScores MethodSummary::*member) {
  std::vector<Score> visible;
  std::vector<Score> all;
  for (const SceneSummary* scene : scenes) {
    visible.push_back((scene->methods[method].*member).visible);
    all.push_back((scene->methods[method].*member).all);
  }
  return {meanScore(visible), meanScore(all)};
}

MethodSummary meanMethod(const Scenes& scenes, std::size_t i) {
  MethodSummary mean = scenes.front()->methods[i];
  mean.plan = PathPlan();
  mean.rounds_ms.clear();
  mean.whole = meanRegions(scenes, i, &MethodSummary::whole);
  mean.in_focus = meanRegions(scenes, i, &MethodSummary::in_focus);
  mean.uniform_in_focus = meanRegions(scenes, i, &MethodSummary::uniform_in_focus);
  const double count = static_cast<double>(scenes.size());
  mean.time_ms = 0.0;
  mean.mean_paths = 0.0;
  std::vector<double> log_ratios(mean.ratios.size(), 0.0);
  for (const SceneSummary* scene : scenes) {
    const MethodSummary& one = scene->methods[i];
    mean.time_ms += one.time_ms / count;
    mean.mean_paths += one.mean_paths / count;
    for (std::size_t k = 0; k < log_ratios.size(); ++k) {
      log_ratios[k] += std::log(one.ratios[k].second) / count;
    }
  }
  for (std::size_t k = 0; k < log_ratios.size(); ++k) {
    mean.ratios[k].second = std::exp(log_ratios[k]);
  }
  return mean;
}

}  // namespace

SceneSummary summarise(const SceneResult& result) {
  SceneSummary summary;
  summary.set = toString(result.scene.layout);
  summary.family = familyOf(result.scene.layout);
  summary.name = result.scene.name;
  summary.left = result.scene.left;
  summary.width = result.images.left.cols;
  summary.height = result.images.left.rows;
  summary.disparity_range = result.disparity_range;
  for (const MethodResult& method : result.methods) {
    MethodSummary one;
    one.method = method.method;
    one.plan = method.plan;
    one.mean_paths = method.method.is_peer ? 0.0 : meanPaths(method.plan);
    one.whole = method.whole;
    one.in_focus = method.in_focus;
    one.uniform_in_focus = method.uniform_in_focus;
    one.time_ms = medianOf(method.time_ms);
    one.rounds_ms = method.time_ms;
    for (const MethodResult& peer : result.methods) {
      if (peer.method.is_peer) one.ratios.emplace_back(peer.method.name, timeRatio(method, peer));
    }
    summary.methods.push_back(one);
  }
  return summary;
}

std::vector<FamilySummary> familyMeans(const std::vector<SceneSummary>& scenes) {
  std::vector<std::pair<std::string, Scenes>> families;
  for (const SceneSummary& scene : scenes) {
    auto family = std::find_if(families.begin(), families.end(),
                               [&](const auto& one) { return one.first == scene.family; });
    if (family == families.end()) {
      families.emplace_back(scene.family, Scenes());
      family = std::prev(families.end());
    }
    family->second.push_back(&scene);
  }
  std::vector<FamilySummary> means;
  for (const auto& [name, members] : families) {
    FamilySummary mean;
    mean.family = name;
    mean.scenes = static_cast<int>(members.size());
    for (std::size_t i = 0; i < members.front()->methods.size(); ++i) {
      mean.methods.push_back(meanMethod(members, i));
    }
    means.push_back(mean);
  }
  return means;
}

}  // namespace adaptive_grid_stereo
