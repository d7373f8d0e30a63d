// The whole matcher against OpenCV's, taking turns in one run.

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <iostream>
#include <regex>
#include <sstream>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "command_line.h"
#include "comparison.h"
#include "output_file.h"
#include "progress_bar.h"
#include "targets.h"
#include "text_table.h"
#include "textured_pair.h"

namespace po = boost::program_options;
using namespace adaptive_grid_stereo;

namespace {

const char kTool[] = "matcher_benchmark";

struct Options {
  std::string data;
  std::string json;
  std::string sizes;
  std::string simd_target;
  std::vector<int> threads{1, 2};
  int rounds = 15;
  bool force = false;
};

bool readOptions(int argc, char** argv, Options* o) {
  const ToolHelp help{
      kTool, "[options]",
      "Times every path plan and OpenCV's matchers at six sizes, taking turns, and\n"
      "prints medians, ratios and the figures that the matcher is held to.",
      ""};
  po::options_description options("options");
  options.add_options()("data", po::value(&o->data)->value_name("DIR"),
                        "where middlebury/2003/teddy lies; ADAPTIVE_GRID_STEREO_DATA if not given")(
      "rounds", po::value(&o->rounds)->default_value(o->rounds)->value_name("N"), "rounds counted")(
      "threads", po::value(&o->threads)->multitoken()->value_name("N..."),
      "numbers of threads; 1 2 if not given")(
      "sizes", po::value(&o->sizes)->value_name("REGEX"),
      "only sizes in whose name this is found, e.g. '450x375|1280'")(
      "simd-target", po::value(&o->simd_target)->value_name("NAME"),
      "what ours runs on, e.g. AVX2; the best that the CPU has if not given")(
      "json", po::value(&o->json)->value_name("FILE"), "every time of every round")(
      "force", po::bool_switch(&o->force), "overwrite the file");
  po::variables_map values;
  if (!parseCommandLine(argc, argv, help, options, {}, &values)) return false;
  if (o->rounds < 1) throw UsageError("--rounds must be at least 1");
  for (const int count : o->threads) {
    if (count < 1 || count > 256) throw UsageError("--threads must be from 1 to 256");
  }
  if (o->data.empty()) {
    const char* directory = std::getenv("ADAPTIVE_GRID_STEREO_DATA");
    o->data = directory ? directory : "";
  }
  return true;
}

Setting makeSetting(int width, int height, int disparity_range, const std::string& data) {
  Setting setting{width, height, disparity_range, "textured", cv::Mat(), cv::Mat()};
  if (width == 450 && !data.empty()) {
    const std::string teddy = data + "/middlebury/2003/teddy/";
    setting.left = cv::imread(teddy + "im2.png", cv::IMREAD_GRAYSCALE);
    setting.right = cv::imread(teddy + "im6.png", cv::IMREAD_GRAYSCALE);
    setting.images = "Teddy";
  }
  const cv::Size size(width, height);
  if (setting.left.size() != size || setting.right.size() != size) {
    const TexturedPair pair = makeTexturedPair(width, height, disparity_range);
    setting.left = pair.left;
    setting.right = pair.right;
    setting.images = "textured";
  }
  return setting;
}

std::vector<Setting> chosenSettings(const Options& o) {
  const std::regex filter(o.sizes);
  std::vector<Setting> settings;
  const int sizes[][3] = {{256, 144, 64},  {450, 375, 64},   {640, 480, 64},
                          {640, 480, 128}, {1024, 440, 128}, {1280, 720, 128}};
  for (const auto& size : sizes) {
    Setting name_only{size[0], size[1], size[2], "", cv::Mat(), cv::Mat()};
    if (!std::regex_search(nameOf(name_only), filter)) continue;
    settings.push_back(makeSetting(size[0], size[1], size[2], o.data));
  }
  if (settings.empty()) throw UsageError("no size has '" + o.sizes + "' in its name");
  return settings;
}

/// Peak memory [MB] of a process that does nothing but match such a pair with all 16 paths; a
/// process of its own, since this one holds the peers' buffers, too. 0 if that failed.
double peakMemory(const Setting& setting) {
  const pid_t child = fork();
  if (child < 0) return 0.0;
  if (child == 0) {
    MatcherConfig config;
    config.disparity_range = setting.disparity_range;
    config.threads = 2;
    StereoMatcher matcher(config);
    const PathPlan plan = uniformPlan(setting.width, setting.height, 16);
    for (int i = 0; i < 2; ++i) matcher.match(setting.left, setting.right, plan);
    _exit(0);
  }
  int status = 0;
  rusage usage{};
  if (wait4(child, &status, 0, &usage) != child || status != 0) return 0.0;
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

void printSetting(const Setting& setting, const std::vector<Series>& all,
                  const std::vector<int>& threads) {
  std::cout << '\n' << nameOf(setting) << " (" << setting.images << ")\n";
  std::vector<std::vector<std::string>> lines{{"method", "paths"}};
  for (const int count : threads) {
    const std::string suffix = " (" + std::to_string(count) + "T)";
    for (const char* column : {"ms", "of BM", "of 3WAY", "of SGBM"}) {
      lines[0].push_back(column + suffix);
    }
    for (const char* stage : {"census", "sweeps", "refine"}) lines[0].push_back(stage);
  }
  for (const Series& first : all) {
    if (first.setting != nameOf(setting) || first.threads != threads.front()) continue;
    std::vector<std::string> line{first.method,
                                  first.mean_paths > 0.0 ? fixed(first.mean_paths, 2) : "-"};
    for (const int count : threads) {
      const Series* series = find(all, first.setting, first.method, count);
      line.push_back(fixed(medianTime(*series), 2));
      for (const char* peer : {"StereoBM", "SGBM 3WAY", "SGBM"}) {
        line.push_back(fixed(medianRatio(*series, *find(all, first.setting, peer, count)), 2));
      }
      Series stage;
      for (double StageTimes::*member :
           {&StageTimes::census, &StageTimes::sweeps, &StageTimes::refinement}) {
        stage.time_ms.clear();
        for (const StageTimes& times : series->stages) stage.time_ms.push_back(times.*member);
        line.push_back(series->stages.empty() ? "-" : fixed(medianTime(stage), 2));
      }
    }
    lines.push_back(line);
  }
  std::cout << textTable(lines);
}

/// How far several threads get beside what the machine allows for: as many frames at once, whose
/// threads have nothing to do with each other.
void printThreads(const std::vector<Series>& all) {
  std::vector<std::vector<std::string>> lines{{"size", "method", "threads", "of one thread's time",
                                               "frames at once, of one's", "of frames at once"}};
  for (const Series& series : all) {
    const Series* at_once = find(all, series.setting, series.method + kAtOnce, series.threads);
    const Series* one = find(all, series.setting, series.method, 1);
    if (!at_once || !one) continue;
    lines.push_back({series.setting, series.method, std::to_string(series.threads),
                     fixed(medianRatio(series, *one), 2), fixed(medianRatio(*at_once, *one), 2),
                     fixed(medianRatio(series, *at_once), 2)});
  }
  if (lines.size() > 1) std::cout << '\n' << textTable(lines);
}

void printTargets(const std::vector<Target>& targets) {
  std::vector<std::vector<std::string>> lines{
      {"figure", "bar", "stretch", "measured", "reaches", "where"}};
  for (const Target& target : targets) {
    const int decimals = target.bar >= 10.0 ? 1 : 2;
    const std::string unit = target.unit.empty() ? "" : " " + target.unit;
    lines.push_back({target.name, fixed(target.bar, decimals), fixed(target.stretch, decimals),
                     target.measured ? fixed(target.value, decimals + 1) + unit : "-",
                     verdict(target), target.where});
  }
  std::cout << '\n' << textTable(lines);
}

std::string cpuName() {
  std::ifstream info("/proc/cpuinfo");
  std::string line;
  while (std::getline(info, line)) {
    const std::size_t colon = line.find(": ");
    if (line.rfind("model name", 0) == 0 && colon != std::string::npos) {
      return line.substr(colon + 2);
    }
  }
  return "unknown";
}

std::string toJson(const std::vector<Setting>& settings, const std::vector<Series>& all,
                   const std::vector<Target>& targets, const Options& o) {
  nlohmann::ordered_json json;
  json["cpu"] = cpuName();
  json["simd_target"] = simdTarget();
  json["opencv"] = CV_VERSION;
  json["rounds"] = o.rounds;
  for (const Setting& setting : settings) json["images"][nameOf(setting)] = setting.images;
  for (const Series& series : all) {
    nlohmann::ordered_json one;
    one["setting"] = series.setting;
    one["method"] = series.method;
    one["threads"] = series.threads;
    one["mean_paths"] = series.mean_paths;
    one["median_ms"] = medianTime(series);
    one["time_ms"] = series.time_ms;
    for (const StageTimes& times : series.stages) {
      one["census_ms"].push_back(times.census);
      one["sweeps_ms"].push_back(times.sweeps);
      one["refinement_ms"].push_back(times.refinement);
    }
    json["series"].push_back(one);
  }
  for (const Target& target : targets) {
    nlohmann::ordered_json one{{"figure", target.name},      {"unit", target.unit},
                               {"bar", target.bar},          {"stretch", target.stretch},
                               {"reaches", verdict(target)}, {"where", target.where}};
    if (target.measured) one["measured"] = target.value;
    json["targets"].push_back(one);
  }
  return json.dump(1) + "\n";
}

/// All sizes, in passes of some rounds each: what a machine shared with others does for a minute
/// then meets no size in all of its rounds. (Not round by round, which would keep the buffers of
/// all sizes at once.)
std::vector<Series> compareAll(const std::vector<Setting>& settings, const Options& o) {
  constexpr int kPasses = 3;
  ProgressBar progress("runs", runsOf(o.threads, o.rounds) * static_cast<long>(settings.size()));
  long done = 0;
  std::vector<Series> all;
  for (int pass = 0; pass < kPasses; ++pass) {
    const int rounds = o.rounds * (pass + 1) / kPasses - o.rounds * pass / kPasses;
    for (const Setting& setting : settings) {
      if (rounds == 0) continue;
      append(compare(setting, o.threads, rounds, [&] { progress.update(++done, nameOf(setting)); }),
             &all);
    }
  }
  progress.finish();
  return all;
}

int run(int argc, char** argv) {
  Options o;
  if (!readOptions(argc, argv, &o)) return 0;
  if (!o.json.empty()) checkWritable(o.json, o.force);
  useSimdTarget(o.simd_target);
  const std::vector<Setting> settings = chosenSettings(o);
  // Before any thread exists, since a forked child has only one.
  double peak_memory_mb = 0.0;
  if (nameOf(settings.back()) == "1280x720x128") peak_memory_mb = peakMemory(settings.back());

  const std::vector<Series> all = compareAll(settings, o);
  std::cout << cpuName() << ", " << simdTarget() << ", OpenCV " << CV_VERSION << ", medians of "
            << o.rounds << " rounds\n";
  for (const Setting& setting : settings) printSetting(setting, all, o.threads);
  printThreads(all);
  const std::vector<Target> targets = evaluateTargets(all, peak_memory_mb);
  printTargets(targets);
  if (!o.json.empty()) writeFile(o.json, toJson(settings, all, targets, o), o.force);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(kTool, [&] { return run(argc, argv); });
}
