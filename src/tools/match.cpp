// One stereo pair from files to a disparity map, without ROS.

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <limits>
#include <sstream>
#include <thread>
#include <vector>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "adaptive_grid_stereo/matching/stereo_matcher.h"
#include "command_line.h"
#include "image_file.h"
#include "motion_plan.h"
#include "output_file.h"
#include "pfm.h"
#include "pictures.h"

namespace po = boost::program_options;
using namespace adaptive_grid_stereo;

namespace {

const char kTool[] = "match";

struct Options {
  MatcherConfig matcher;
  GuidanceConfig guidance;
  std::string left;
  std::string right;
  std::string output;
  std::string json;
  std::string png;
  bool force = false;
  int repeat = 1;
  int paths = 16;
  bool by_motion = false;
  PlannedMotion motion;
};

/// False if the user asked for help only.
bool readOptions(int argc, char** argv, Options* o) {
  const ToolHelp help{
      kTool, "LEFT RIGHT --output D.pfm [options]",
      "Matches one rectified stereo pair and writes the left image's disparity as PFM\n"
      "(Middlebury convention: inf = invalid). Needs no ROS master.",
      "  match im2.png im6.png --output teddy.pfm --png teddy.png\n"
      "  match im2.png im6.png --output left_turn.pfm --speed 15 --yaw-rate 0.5\n"};
  po::options_description files("files");
  files.add_options()("output", po::value(&o->output)->value_name("FILE"), "disparity as PFM")(
      "png", po::value(&o->png)->value_name("FILE"), "disparity in colour as PNG")(
      "json", po::value(&o->json)->value_name("FILE"), "time, plan and density as JSON")(
      "force", po::bool_switch(&o->force), "overwrite files that exist");
  po::options_description plan("path plan");
  plan.add_options()("paths", po::value(&o->paths)->value_name("16|8|4"),
                     "the same number of paths everywhere (the default, with 16)")(
      "speed", po::value(&o->motion.speed)->value_name("V"),
      "plan for this forward speed [m/s] instead")(
      "yaw-rate", po::value(&o->motion.yaw_rate)->value_name("Y"),
      "turn of the camera, left positive [rad/s]; with --speed")(
      "pitch-rate", po::value(&o->motion.pitch_rate)->value_name("P"),
      "turn of the camera, up positive [rad/s]; with --speed");
  po::options_description run("measuring");
  run.add_options()("repeat", po::value(&o->repeat)->value_name("N"),
                    "match N times; the JSON holds the median time");
  po::options_description all;
  all.add(files)
      .add(plan)
      .add(run)
      .add(matcherOptions(&o->matcher))
      .add(guidanceOptions(&o->guidance));
  po::variables_map values;
  if (!parseCommandLine(argc, argv, help, all, {"left", "right"}, &values)) return false;

  if (values.count("left") == 0 || values.count("right") == 0) {
    throw UsageError("two images are needed: match LEFT RIGHT --output D.pfm");
  }
  o->left = values["left"].as<std::string>();
  o->right = values["right"].as<std::string>();
  if (o->output.empty()) throw UsageError("--output D.pfm is missing");
  if (o->repeat < 1) throw UsageError("--repeat must be at least 1");
  if (o->paths != 4 && o->paths != 8 && o->paths != 16) {
    throw UsageError("--paths " + std::to_string(o->paths) + ": expected 16, 8 or 4");
  }
  o->by_motion = values.count("speed") > 0;
  if (!o->by_motion && (values.count("yaw-rate") > 0 || values.count("pitch-rate") > 0)) {
    throw UsageError("--yaw-rate and --pitch-rate need --speed: a standing aircraft has no focus");
  }
  if (o->by_motion && values.count("paths") > 0) {
    throw UsageError("--paths asks for a uniform plan, --speed for an adaptive one: choose one");
  }
  for (const double rate : {o->motion.speed, o->motion.yaw_rate, o->motion.pitch_rate}) {
    if (!std::isfinite(rate)) throw UsageError("speed and rates must be finite numbers");
  }
  return true;
}

void checkPair(const Options& o, const cv::Mat& left, const cv::Mat& right) {
  std::ostringstream text;
  if (left.size() != right.size()) {
    text << o.left << " is " << left.cols << 'x' << left.rows << ", " << o.right << " is "
         << right.cols << 'x' << right.rows << ": a rectified pair has one size";
  } else if (std::min(left.cols, left.rows) < kMinImageSide) {
    text << o.left << " is " << left.cols << 'x' << left.rows << ": at least " << kMinImageSide
         << 'x' << kMinImageSide << " is needed";
  }
  if (!text.str().empty()) throw std::runtime_error(text.str());
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return (*middle + *std::max_element(values.begin(), middle)) / 2.0;
}

/// Share of valid pixels; marks the others with inf in `disparity`.
double markInvalid(int min_disparity, cv::Mat* disparity) {
  long valid = 0;
  for (int y = 0; y < disparity->rows; ++y) {
    float* row = disparity->ptr<float>(y);
    for (int x = 0; x < disparity->cols; ++x) {
      if (row[x] >= static_cast<float>(min_disparity)) {
        ++valid;
      } else {
        row[x] = std::numeric_limits<float>::infinity();
      }
    }
  }
  return static_cast<double>(valid) / static_cast<double>(disparity->total());
}

double peakMemoryMegabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

std::string report(const Options& o, const MotionPlan& flight, const cv::Mat& disparity,
                   double time_ms, const StageTimes& stages, double density) {
  const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  nlohmann::ordered_json json;
  json["time_ms"] = time_ms;
  json["repeat"] = o.repeat;
  json["stages_ms"] = {
      {"census", stages.census}, {"sweeps", stages.sweeps}, {"refinement", stages.refinement}};
  json["state"] = flight.state;
  json["paths"] = flight.plan.paths;
  json["column_edges"] = flight.plan.column_edges;
  json["row_edges"] = flight.plan.row_edges;
  json["mean_paths"] = meanPaths(flight.plan);
  json["density"] = density;
  json["width"] = disparity.cols;
  json["height"] = disparity.rows;
  json["min_disparity"] = o.matcher.min_disparity;
  json["disparity_range"] = o.matcher.disparity_range;
  json["threads"] = o.matcher.threads > 0 ? o.matcher.threads : cores;
  json["simd_target"] = simdTarget();
  json["peak_memory_mb"] = peakMemoryMegabytes();
  return json.dump(2) + "\n";
}

int run(int argc, char** argv) {
  Options o;
  if (!readOptions(argc, argv, &o)) return 0;
  reportCorrections(kTool, o.matcher.validate());
  reportCorrections(kTool, o.guidance.validate());
  checkDistinct({o.output, o.png, o.json});
  for (const std::string& path : {o.output, o.png, o.json}) {
    if (!path.empty()) checkWritable(path, o.force);
  }
  const auto [left, right] = readGreyPair(o.left, o.right);
  checkPair(o, left, right);
  const MotionPlan flight = o.by_motion
                                ? planForMotion(o.motion, o.guidance, left.size())
                                : MotionPlan{"UNIFORM", uniformPlan(left.cols, left.rows, o.paths)};

  StereoMatcher matcher(o.matcher);
  std::vector<double> times;
  cv::Mat disparity;
  StageTimes stages;
  for (int i = 0; i < o.repeat; ++i) {
    const auto start = std::chrono::steady_clock::now();
    const MatchResult& result = matcher.match(left, right, flight.plan);
    const std::chrono::duration<double, std::milli> spent =
        std::chrono::steady_clock::now() - start;
    times.push_back(spent.count());
    if (i + 1 < o.repeat) continue;
    disparity = toFloatDisparity(result);
    stages = result.times;
  }
  const double density = markInvalid(o.matcher.min_disparity, &disparity);
  const double time_ms = median(times);

  std::ostringstream pfm;
  writePfm(pfm, disparity);
  writeFile(o.output, pfm.str(), o.force);
  if (!o.png.empty()) {
    cv::Mat picture = colourDisparity(disparity, o.matcher.min_disparity,
                                      o.matcher.min_disparity + o.matcher.disparity_range - 1);
    if (o.by_motion) drawPlan(flight.plan, &picture);
    writePng(o.png, picture, o.force);
  }
  if (!o.json.empty()) {
    writeFile(o.json, report(o, flight, disparity, time_ms, stages, density), o.force);
  }
  std::cout << flight.state << ": " << time_ms << " ms, " << 100.0 * density << " % valid, "
            << o.output << '\n';
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(kTool, [&] { return run(argc, argv); });
}
