// Scores the matcher and OpenCV's on public stereo sets.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <map>
#include <regex>
#include <sstream>
#include <thread>

#include <opencv2/core/utility.hpp>

#include "command_line.h"
#include "evaluation_report.h"
#include "output_file.h"
#include "pictures.h"
#include "progress_bar.h"

namespace fs = std::filesystem;
namespace po = boost::program_options;
using namespace adaptive_grid_stereo;

namespace {

const char kTool[] = "evaluate";

struct Options {
  EvaluationOptions evaluation;
  std::vector<std::string> directories;
  std::string output;
  std::string methods;
  std::string scenes;
  std::vector<double> speeds;
  double turn_speed = 0.0;  // 0: V_max
  bool no_peers = false;
  bool per_scene = false;
  bool force = false;
};

bool readOptions(int argc, char** argv, Options* o) {
  const ToolHelp help{
      kTool, "DIR... [options]",
      "Scores our path plans and OpenCV's matchers on stereo sets as their sites ship them:\n"
      "Middlebury 2003, MiddEval3, KITTI 2012 and 2015, ETH3D two-view, found anywhere below DIR.\n"
      "Prints the means of each set; --output adds CSV, JSON and a picture of every scene.",
      "  evaluate middlebury kitti2012 --output results\n"
      "  evaluate middlebury --methods 'uniform|forward' --penalty-small 12 --repeat 1\n"};
  po::options_description what("what to run");
  what.add_options()(
      "speeds", po::value(&o->speeds)->multitoken()->value_name("V..."),
      "forward speeds to plan for [m/s]; a sixth and all of --max-speed if not given")(
      "turn-speed", po::value(&o->turn_speed)->value_name("V"),
      "forward speed during the turns [m/s]; --max-speed if not given")(
      "no-peers", po::bool_switch(&o->no_peers), "leave OpenCV's matchers out")(
      "methods", po::value(&o->methods)->value_name("REGEX"),
      "only methods in whose name this is found, e.g. 'uniform 16|SGBM'")(
      "scenes", po::value(&o->scenes)->value_name("REGEX"),
      "only scenes in whose path this is found")(
      "repeat", po::value(&o->evaluation.repeat)->default_value(5)->value_name("N"),
      "rounds; times are medians over them");
  po::options_description where("output");
  where.add_options()("output", po::value(&o->output)->value_name("DIR"),
                      "folder for results.csv, results.json and the pictures; made if needed")(
      "per-scene", po::bool_switch(&o->per_scene), "print the table of every scene, too")(
      "force", po::bool_switch(&o->force), "overwrite files that exist");
  po::options_description all;
  all.add(what)
      .add(where)
      .add(matcherOptions(&o->evaluation.matcher))
      .add(guidanceOptions(&o->evaluation.guidance));
  po::variables_map values;
  if (!parseCommandLine(argc, argv, help, all, {"directory*"}, &values)) return false;
  if (values.count("directory") == 0) throw UsageError("name at least one directory with a set");
  o->directories = values["directory"].as<std::vector<std::string>>();
  o->evaluation.own_range = !values["disparity-range"].defaulted();
  if (o->evaluation.repeat < 1) throw UsageError("--repeat must be at least 1");
  return true;
}

std::regex regexOf(const std::string& option, const std::string& text) {
  try {
    return std::regex(text);
  } catch (const std::regex_error& error) {
    throw UsageError(option + " '" + text + "' is no regular expression: " + error.what());
  }
}

void chooseMethods(Options* o) {
  if (o->speeds.empty()) {
    o->speeds = {o->evaluation.guidance.max_speed / 6, o->evaluation.guidance.max_speed};
  }
  if (o->turn_speed <= 0.0) o->turn_speed = o->evaluation.guidance.max_speed;
  const std::regex filter = regexOf("--methods", o->methods);
  for (const double speed : o->speeds) {
    if (!std::isfinite(speed)) throw UsageError("--speeds must be finite numbers");
  }
  for (const Method& method : defaultMethods(o->evaluation.guidance, o->speeds, o->turn_speed)) {
    if (method.is_peer && o->no_peers) continue;
    if (std::regex_search(method.name, filter)) o->evaluation.methods.push_back(method);
  }
  if (o->evaluation.methods.empty()) throw UsageError("no method's name has '" + o->methods + "'");
}

std::vector<Scene> chooseScenes(const Options& o) {
  const std::regex filter = regexOf("--scenes", o.scenes);
  std::vector<Scene> scenes;
  for (const std::string& directory : o.directories) {
    for (const Scene& scene : findScenes(directory)) {
      const bool known = std::any_of(scenes.begin(), scenes.end(),
                                     [&](const Scene& s) { return s.left == scene.left; });
      if (!known && std::regex_search(scene.left, filter)) scenes.push_back(scene);
    }
  }
  if (scenes.empty()) {
    throw std::runtime_error(
        "no stereo pair found: expected Middlebury 2003 (im2, im6), MiddEval3 or ETH3D (im0, im1), "
        "KITTI 2012 (image_0, image_1) or KITTI 2015 (image_2, image_3) below the directories");
  }
  return scenes;
}

/// A file for each scene's picture. Scenes of one name, of one dataset in two sizes for instance,
/// are numbered.
std::vector<std::string> picturePaths(const Options& o, const std::vector<Scene>& scenes) {
  std::vector<std::string> paths;
  std::map<std::string, int> times;
  for (const Scene& scene : scenes) {
    std::string name = std::string(toString(scene.layout)) + "_" + scene.name;
    std::replace(name.begin(), name.end(), ' ', '_');
    const int time = ++times[name];
    if (time > 1) name += "_" + std::to_string(time);
    paths.push_back((fs::path(o.output) / (name + ".png")).string());
  }
  return paths;
}

void prepareOutput(const Options& o, const std::vector<std::string>& pictures) {
  if (o.output.empty()) return;
  std::error_code error;
  fs::create_directories(o.output, error);
  if (error) throw std::runtime_error(o.output + ": cannot be made: " + error.message());
  checkWritable((fs::path(o.output) / "results.csv").string(), o.force);
  checkWritable((fs::path(o.output) / "results.json").string(), o.force);
  for (const std::string& picture : pictures) checkWritable(picture, o.force);
}

void printTables(const Options& o, const std::vector<SceneSummary>& summaries) {
  if (o.per_scene) {
    for (const SceneSummary& scene : summaries) {
      std::cout << '\n'
                << scene.set << ", " << scene.name << ": " << scene.width << 'x' << scene.height
                << ", " << scene.disparity_range << " disparities\n"
                << methodTable(scene.methods);
    }
  }
  for (const FamilySummary& family : familyMeans(summaries)) {
    std::cout << '\n'
              << family.family << ", mean of " << family.scenes << " scenes\n"
              << methodTable(family.methods);
  }
  std::cout << '\n' << tableLegend();
}

std::string commandOf(int argc, char** argv) {
  std::string command = kTool;
  for (int i = 1; i < argc; ++i) command += std::string(" ") + argv[i];
  return command;
}

int run(int argc, char** argv) {
  Options o;
  if (!readOptions(argc, argv, &o)) return 0;
  reportCorrections(kTool, o.evaluation.matcher.validate());
  reportCorrections(kTool, o.evaluation.guidance.validate());
  chooseMethods(&o);
  const std::vector<Scene> scenes = chooseScenes(o);
  const std::vector<std::string> pictures = picturePaths(o, scenes);
  prepareOutput(o, pictures);
  const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  const int threads = o.evaluation.matcher.threads > 0 ? o.evaluation.matcher.threads : cores;
  cv::setNumThreads(threads);

  const long runs_per_scene = static_cast<long>(o.evaluation.methods.size()) * o.evaluation.repeat;
  ProgressBar progress("runs", runs_per_scene * static_cast<long>(scenes.size()));
  long done = 0;
  std::vector<SceneSummary> summaries;
  bool damaged = false;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    try {
      const SceneResult result =
          evaluateScene(scenes[i], o.evaluation, [&] { progress.update(++done, scenes[i].name); });
      summaries.push_back(summarise(result));
      if (!o.output.empty()) writePng(pictures[i], scenePicture(result), o.force);
    } catch (const std::exception& error) {
      progress.finish();
      std::cerr << kTool << ": scene left out: " << error.what() << '\n';
      damaged = true;
    }
    done = static_cast<long>(i + 1) * runs_per_scene;
  }
  progress.finish();
  if (summaries.empty()) throw std::runtime_error("none of the scenes could be read");
  printTables(o, summaries);
  if (!o.output.empty()) {
    const EvaluationSetting setting{commandOf(argc, argv), threads, o.evaluation.repeat};
    writeFile((fs::path(o.output) / "results.csv").string(), toCsv(summaries), o.force);
    writeFile((fs::path(o.output) / "results.json").string(), toJson(summaries, setting), o.force);
  }
  return damaged ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(kTool, [&] { return run(argc, argv); });
}
