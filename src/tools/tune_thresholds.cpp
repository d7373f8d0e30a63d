// tune_thresholds BAG: reads the motion of a flight and says which thresholds suit the aircraft.

#include <sys/wait.h>
#include <unistd.h>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <sstream>

#include <ros/time.h>
#include <nlohmann/json.hpp>

#include "adaptive_grid_stereo/guidance/flight_state.h"
#include "command_line.h"
#include "motion_log.h"
#include "output_file.h"
#include "text_table.h"
#include "threshold_tuning.h"

namespace adaptive_grid_stereo {
namespace {

constexpr const char* kTool = "tune_thresholds";
constexpr double kRate = 50.0;  // [Hz]

struct Options {
  std::string bag;
  std::string output = "tune_thresholds";
  std::string optical_frame;
  double calm = 20.0;
  bool force = false;
  NamedTopics topics;
  MotionConfig motion;
  GuidanceConfig guidance;
};

std::vector<MotionPoint> readMotion(const Options& options, const MotionConfig& config,
                                    std::string* sources) {
  BagReader bag(options.bag);
  MotionSubscriber subscriber(config);
  MotionReplay replay;
  std::vector<std::string> notes;
  replay.topics = chooseMotionTopics(bag.connections(), options.topics, &notes);
  // The bag is read twice; its doubts are said once.
  if (sources != nullptr) reportCorrections(kTool, notes);
  replay.optical_frame = options.optical_frame;
  replay.rate = kRate;
  std::vector<MotionPoint> points;
  std::string speed_source, rate_source, reason = "the bag holds no motion topics";
  replayMotion(&bag, replay, &subscriber, [&](double stamp, const Motion& motion) {
    points.push_back(
        {stamp, motion.valid, motion.forward_speed, motion.yaw_rate, motion.pitch_rate});
    if (motion.valid) {
      speed_source = motion.speed_source;
      rate_source = motion.rate_source;
    } else {
      reason = motion.reason;
    }
  });
  if (speed_source.empty()) {
    throw std::runtime_error(options.bag + ": the motion is never known: " + reason +
                             "; name the topics with --odom, --imu, --gps-vel, --gps-fix");
  }
  if (sources != nullptr) *sources = "speed from " + speed_source + ", rates from " + rate_source;
  return points;
}

std::vector<std::string> rowText(const TuningRow& row) {
  const auto percent = [](double share) { return fixed(100.0 * share, 1); };
  return {fixed(row.sigma1, 2), fixed(row.sigma2, 2),
          percent(row.locked),  percent(row.forward),
          percent(row.yaw),     percent(row.pitch),
          percent(row.both),    fixed(row.changes_per_minute, 1),
          percent(row.cost)};
}

const std::vector<std::string> kHeading = {"sigma1",  "sigma2", "LOCKED %",    "FORWARD %", "YAW %",
                                           "PITCH %", "both %", "changes/min", "cost %"};

std::string csv(const std::vector<TuningRow>& rows) {
  std::ostringstream text;
  text << "sigma1,sigma2,locked,forward,yaw,pitch,both,changes_per_minute,cost\n";
  for (const TuningRow& r : rows) {
    text << r.sigma1 << ',' << r.sigma2 << ',' << r.locked << ',' << r.forward << ',' << r.yaw
         << ',' << r.pitch << ',' << r.both << ',' << r.changes_per_minute << ',' << r.cost << '\n';
  }
  return text.str();
}

std::string yaml(const TuningAdvice& advice) {
  std::ostringstream text;
  for (const std::string& reason : advice.reasons) text << "# " << reason << ".\n";
  const GuidanceConfig& c = advice.config;
  text << "max_speed: " << fixed(c.max_speed, 1) << "\nmax_yaw_rate: " << fixed(c.max_yaw_rate, 2)
       << "\nmax_pitch_rate: " << fixed(c.max_pitch_rate, 2) << "\nsigma1: " << fixed(c.sigma1, 2)
       << "\nsigma2: " << fixed(c.sigma2, 2) << "\n";
  return text.str();
}

/// Changes per minute with and without the low-pass and the hysteresis.
std::string calmTable(const Options& options, const std::vector<MotionPoint>& filtered) {
  MotionConfig raw_config = options.motion;
  raw_config.rate_filter_time = 0.0;
  const std::vector<MotionPoint> raw = readMotion(options, raw_config, nullptr);
  GuidanceConfig without = options.guidance;
  without.hysteresis = 1.0;
  without.min_dwell_time = 0.0;
  const auto changes = [](const std::vector<MotionPoint>& points, const GuidanceConfig& config) {
    return fixed(tuneAt(points, config).changes_per_minute, 1);
  };
  return textTable(
      {{"state changes a minute", "no hysteresis", "hysteresis"},
       {"rates as they are", changes(raw, without), changes(raw, options.guidance)},
       {"rates low-passed", changes(filtered, without), changes(filtered, options.guidance)}});
}

nlohmann::json thresholds(const GuidanceConfig& config) {
  return {{"lock_speed", config.lock_speed},
          {"max_speed", config.max_speed},
          {"yaw", config.sigma1 * config.max_yaw_rate},
          {"pitch", config.sigma2 * config.max_pitch_rate},
          {"hysteresis", config.hysteresis}};
}

/// What the picture shows: the flight under the suggested thresholds.
std::string pictureData(const Options& options, const std::vector<MotionPoint>& points,
                        const TuningAdvice& advice, const std::vector<TuningRow>& rows) {
  nlohmann::json data;
  data["title"] = options.bag;
  data["suggested"] = thresholds(advice.config);
  data["given"] = thresholds(options.guidance);
  data["advice"] = yaml(advice);
  FlightStateMachine machine;
  for (const MotionPoint& point : points) {
    Motion motion;
    motion.valid = point.valid;
    motion.forward_speed = point.forward_speed;
    motion.yaw_rate = point.yaw_rate;
    motion.pitch_rate = point.pitch_rate;
    const FlightState state = machine.update(motion, point.stamp, advice.config);
    const int bits = (state.locked ? 1 : 0) | (state.forward ? 2 : 0) |
                     (state.yaw != YawSide::kNone ? 4 : 0) |
                     (state.pitch != PitchSide::kNone ? 8 : 0);
    data["time"].push_back(point.stamp - points.front().stamp);
    data["state"].push_back(bits);
    data["speed"].push_back(point.valid ? point.forward_speed : std::nan(""));
    data["yaw"].push_back(point.valid ? point.yaw_rate : std::nan(""));
    data["pitch"].push_back(point.valid ? point.pitch_rate : std::nan(""));
  }
  for (const TuningRow& row : rows) {
    data["grid"].push_back({{"sigma1", row.sigma1},
                            {"sigma2", row.sigma2},
                            {"changes", row.changes_per_minute},
                            {"cost", row.cost}});
  }
  return data.dump();
}

/// The folder of this executable, beside which the plotting script is installed.
std::string ownFolder() {
  char path[4096];
  const ssize_t length = readlink("/proc/self/exe", path, sizeof(path) - 1);
  const std::string self(path, length > 0 ? static_cast<std::size_t>(length) : 0);
  return self.substr(0, self.find_last_of('/'));
}

/// Runs the plotting script; false, with a sentence on stderr, if there is no picture.
bool plot(const std::string& data, const std::string& picture) {
  const std::string script = ownFolder() + "/plot_thresholds.py";
  const pid_t child = fork();
  if (child == 0) {
    // By its own first line: the installed script names the Python that has matplotlib.
    execl(script.c_str(), script.c_str(), data.c_str(), picture.c_str(),
          static_cast<char*>(nullptr));
    _exit(127);
  }
  int status = 0;
  if (child > 0) waitpid(child, &status, 0);
  if (child > 0 && WIFEXITED(status) && WEXITSTATUS(status) == 0) return true;
  std::cerr << kTool << ": no picture: " << script
            << " failed (is python3-matplotlib installed?)\n";
  return false;
}

int run(const Options& options) {
  const std::string picture = options.output + ".png", table = options.output + ".csv";
  const std::string parameters = options.output + ".yaml";
  for (const std::string& file : {picture, table, parameters}) checkWritable(file, options.force);

  std::string sources;
  const std::vector<MotionPoint> points = readMotion(options, options.motion, &sources);
  const TuningAdvice advice = adviseThresholds(points, options.guidance, options.calm);
  const std::vector<double> sigmas = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7};
  const std::vector<TuningRow> rows = tuneGrid(points, advice.config, sigmas);

  std::vector<std::vector<std::string>> lines = {kHeading};
  for (const TuningRow& row : rows) lines.push_back(rowText(row));
  const TuningRow given = tuneAt(points, options.guidance);
  const TuningRow suggested = tuneAt(points, advice.config);
  std::cout << options.bag << ": " << fixed((points.back().stamp - points.front().stamp), 1)
            << " s, " << sources << "\n\n"
            << textTable(lines) << "\n(cost: of the aggregation, 100 % = 16 paths everywhere; max "
            << "rates as suggested below)\n\n"
            << calmTable(options, points) << "\nwith the parameters given:\n"
            << textTable({kHeading, rowText(given)}) << "\nwith those suggested:\n"
            << textTable({kHeading, rowText(suggested)}) << "\n"
            << yaml(advice);

  writeFile(table, csv(rows), options.force);
  writeFile(parameters, yaml(advice), options.force);
  const std::string data = options.output + ".json.tmp";
  writeFile(data, pictureData(options, points, advice, rows), true);
  const bool plotted = plot(data, picture);
  std::remove(data.c_str());
  std::cout << "\nwritten: " << (plotted ? picture + ", " : "") << table << ", " << parameters
            << "\n";
  return plotted ? 0 : 1;
}

int parseAndRun(int argc, const char* const* argv) {
  namespace po = boost::program_options;
  ros::Time::init();
  Options options;
  po::options_description own("Options");
  own.add_options()  //
      ("output", po::value(&options.output)->default_value(options.output),
       "name of the results without extension")  //
      ("optical-frame", po::value(&options.optical_frame),
       "frame of the left camera, where the bag holds its TF")  //
      ("calm", po::value(&options.calm)->default_value(options.calm),
       "changes a minute that YAW and PITCH may make each")  //
      ("force", po::bool_switch(&options.force), "overwrite existing files");
  own.add(motionTopicOptions(&options.topics))
      .add(motionOptions(&options.motion))
      .add(guidanceOptions(&options.guidance));
  const ToolHelp help = {kTool, "BAG [--output NAME] [options]",
                         "Reads the motion of a flight log and writes a picture, a table and "
                         "parameters ready to load: V_max, largest rates and thresholds that suit "
                         "the aircraft.",
                         "rosrun adaptive_grid_stereo tune_thresholds flight.bag --output tuned"};
  po::variables_map values;
  if (!parseCommandLine(argc, argv, help, own, {"bag"}, &values)) return 0;
  if (values.count("bag") == 0) throw UsageError("a bag is needed: tune_thresholds BAG");
  options.bag = values["bag"].as<std::string>();
  reportCorrections(kTool, options.motion.validate());
  reportCorrections(kTool, options.guidance.validate());
  return run(options);
}

}  // namespace
}  // namespace adaptive_grid_stereo

int main(int argc, char** argv) {
  return adaptive_grid_stereo::runTool(
      adaptive_grid_stereo::kTool, [&] { return adaptive_grid_stereo::parseAndRun(argc, argv); });
}
