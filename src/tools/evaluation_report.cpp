#include "evaluation_report.h"

#include <algorithm>
#include <locale>
#include <sstream>

#include <nlohmann/json.hpp>

#include "adaptive_grid_stereo/matching/stereo_matcher.h"
#include "text_table.h"

namespace adaptive_grid_stereo {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kBad2 = 2;  // index in kBadThresholds

bool isPadded(const std::string& peer) { return peer.find(" padded") != std::string::npos; }

std::string shown(double value, int decimals, bool known) {
  return known ? fixed(value, decimals) : "-";
}

std::string csvQuoted(const std::string& text) {
  std::string quoted = "\"";
  for (const char character : text) {
    if (character == '"') quoted += '"';
    quoted += character;
  }
  return quoted + "\"";
}

/// The four regions of a method by name; those of the focus are without pixels for other methods.
std::vector<std::pair<std::string, Score>> regionsOf(const MethodSummary& method) {
  return {{"visible", method.whole.visible},
          {"all", method.whole.all},
          {"focus visible", method.in_focus.visible},
          {"focus all", method.in_focus.all},
          {"uniform 16 in this focus visible", method.uniform_in_focus.visible},
          {"uniform 16 in this focus all", method.uniform_in_focus.all}};
}

Json toJson(const Score& score) {
  Json json;
  json["pixels"] = score.pixels;
  for (std::size_t i = 0; i < kBadThresholds.size(); ++i) {
    const std::string name = "bad_" + fixed(kBadThresholds[i], 1);
    json[name] = score.bad[i];
    json[name + "_valid_only"] = score.bad_valid[i];
  }
  json["average_error_px"] = score.average_error;
  json["density_percent"] = score.density;
  return json;
}

Json toJson(const MethodSummary& method, bool with_plan) {
  Json json;
  json["method"] = method.method.name;
  if (!method.method.is_peer) {
    json["mean_paths"] = method.mean_paths;
    if (with_plan) {
      json["paths"] = method.plan.paths;
      json["column_edges"] = method.plan.column_edges;
      json["row_edges"] = method.plan.row_edges;
    }
  }
  json["time_ms"] = method.time_ms;
  if (!method.rounds_ms.empty()) json["rounds_ms"] = method.rounds_ms;
  for (const auto& [peer, ratio] : method.ratios) json["time_ratio"][peer] = ratio;
  for (const auto& [region, score] : regionsOf(method)) {
    if (score.pixels > 0) json["error"][region] = toJson(score);
  }
  return json;
}

}  // namespace

std::string methodTable(const std::vector<MethodSummary>& methods) {
  std::vector<std::vector<std::string>> lines{{"method", "paths", "bad0.5", "bad1", "bad2", "bad3",
                                               "bad4", "bad2/valid", "avg", "dens", "bad2/all",
                                               "bad2/focus", "uniform16", "ms"}};
  for (const auto& [peer, ratio] : methods.front().ratios) {
    if (!isPadded(peer)) lines[0].push_back("of " + peer);
  }
  for (const MethodSummary& method : methods) {
    const Score& seen = method.whole.visible;
    const Score& all = method.whole.all;
    const Score& focus = method.in_focus.visible;
    const Score& uniform = method.uniform_in_focus.visible;
    const bool known = seen.pixels > 0;
    std::vector<std::string> line{method.method.name,
                                  shown(method.mean_paths, 2, !method.method.is_peer)};
    for (const double bad : seen.bad) line.push_back(shown(bad, 2, known));
    line.push_back(shown(seen.bad_valid[kBad2], 2, known));
    line.push_back(shown(seen.average_error, 3, known));
    line.push_back(shown(seen.density, 1, known));
    line.push_back(shown(all.bad[kBad2], 2, all.pixels > 0));
    line.push_back(shown(focus.bad[kBad2], 2, focus.pixels > 0));
    line.push_back(shown(uniform.bad[kBad2], 2, uniform.pixels > 0));
    line.push_back(fixed(method.time_ms, 2));
    for (const auto& [peer, ratio] : method.ratios) {
      if (!isPadded(peer)) line.push_back(fixed(ratio, 2));
    }
    lines.push_back(line);
  }
  return textTable(lines);
}

std::string tableLegend() {
  return "paths: mean per pixel. badN: share of the visible (non-occluded) pixels with an error "
         "over N "
         "px, those\nwithout disparity counted as bad [%]; /valid: among pixels with a disparity; "
         "/all: "
         "occluded pixels too;\n/focus: in the plan's focus, beside it uniform 16 in the same box. "
         "avg: "
         "mean error of the visible\npixels that have a disparity [px]. dens: share of visible "
         "pixels "
         "that have one [%]. ms: median time;\n\"of X\": time as a share of X's, median of the "
         "rounds.\n";
}

std::string toCsv(const std::vector<SceneSummary>& scenes) {
  std::ostringstream csv;
  csv.imbue(std::locale::classic());
  csv << "set,scene,width,height,disparity_range,method,mean_paths,region,pixels";
  for (const float bad : kBadThresholds) csv << ",bad_" << fixed(bad, 1);
  for (const float bad : kBadThresholds) csv << ",bad_" << fixed(bad, 1) << "_valid_only";
  csv << ",average_error_px,density_percent,time_ms";
  if (!scenes.empty()) {
    for (const auto& [peer, ratio] : scenes.front().methods.front().ratios) {
      csv << ',' << csvQuoted("time / " + peer);
    }
  }
  csv << '\n';
  for (const SceneSummary& scene : scenes) {
    for (const MethodSummary& method : scene.methods) {
      bool first = true;
      for (const auto& [region, score] : regionsOf(method)) {
        // A scene without truth still has its times: one line, no pixels.
        if (score.pixels == 0 && !(first && method.whole.all.pixels == 0)) continue;
        first = false;
        csv << csvQuoted(scene.set) << ',' << csvQuoted(scene.name) << ',' << scene.width << ','
            << scene.height << ',' << scene.disparity_range << ',' << csvQuoted(method.method.name)
            << ',';
        if (!method.method.is_peer) csv << method.mean_paths;
        csv << ',' << csvQuoted(region) << ',' << score.pixels;
        const bool known = score.pixels > 0;
        for (const double bad : score.bad) csv << ',' << (known ? fixed(bad, 4) : "");
        for (const double bad : score.bad_valid) csv << ',' << (known ? fixed(bad, 4) : "");
        csv << ',' << (known ? fixed(score.average_error, 5) : "") << ','
            << (known ? fixed(score.density, 3) : "") << ',' << fixed(method.time_ms, 4);
        for (const auto& [peer, ratio] : method.ratios) csv << ',' << fixed(ratio, 4);
        csv << '\n';
      }
    }
  }
  return csv.str();
}

std::string toJson(const std::vector<SceneSummary>& scenes, const EvaluationSetting& setting) {
  Json json;
  json["command"] = setting.command;
  json["threads"] = setting.threads;
  json["repeat"] = setting.repeat;
  json["simd_target"] = simdTarget();
  json["means"] = Json::array();
  for (const FamilySummary& family : familyMeans(scenes)) {
    Json one;
    one["family"] = family.family;
    one["scenes"] = family.scenes;
    for (const MethodSummary& method : family.methods) {
      one["methods"].push_back(toJson(method, false));
    }
    json["means"].push_back(one);
  }
  json["scenes"] = Json::array();
  for (const SceneSummary& scene : scenes) {
    Json one;
    one["set"] = scene.set;
    one["scene"] = scene.name;
    one["left"] = scene.left;
    one["width"] = scene.width;
    one["height"] = scene.height;
    one["disparity_range"] = scene.disparity_range;
    for (const MethodSummary& method : scene.methods) {
      one["methods"].push_back(toJson(method, true));
    }
    json["scenes"].push_back(one);
  }
  return json.dump(1) + "\n";
}

}  // namespace adaptive_grid_stereo
