// A recorded flight through the nodelet's frame processor, as fast as the machine goes.

#include <algorithm>
#include <chrono>
#include <fstream>
#include <iostream>
#include <regex>

#include <ros/console.h>
#include <ros/names.h>

#include "adaptive_grid_stereo/ros/stamps.h"
#include "bag_processor.h"
#include "command_line.h"
#include "output_file.h"
#include "progress_bar.h"
#include "text_table.h"
#include "yaml_parameters.h"

namespace po = boost::program_options;
using namespace adaptive_grid_stereo;

namespace {

const char kTool[] = "process_bag";

struct Options {
  std::string input;
  std::string output;
  std::string csv;
  std::string params;
  std::string pass_through;
  std::string rectify = "auto";
  std::string compression = "lz4";
  std::string output_namespace;
  NamedTopics topics;
  ParameterValues values;
  WantedOutputs wanted;
  bool timing = false;
  bool recover = false;
  bool force = false;
};

/// The name space without a slash at its end; empty for the root.
std::string checkedNamespace(std::string name) {
  std::string error;
  if (!ros::names::validate(name, error)) throw UsageError("--namespace " + name + ": " + error);
  while (!name.empty() && name.back() == '/') name.pop_back();
  return name.empty() || name.front() == '/' ? name : "/" + name;
}

po::options_description outputOptions(Options* o) {
  po::options_description options("output");
  options.add_options()("output", po::value(&o->output)->value_name("OUT.bag"),
                        "where disparity and grid_state go")(
      "depth", po::bool_switch(&o->wanted.depth), "write depth images, too")(
      "overlay", po::bool_switch(&o->wanted.overlay), "write grid_overlay, too")(
      "color", po::bool_switch(&o->wanted.disparity_color), "write disparity_color, too")(
      "csv", po::value(&o->csv)->value_name("FILE"), "grid_state as CSV, too")(
      "pass-through", po::value(&o->pass_through)->value_name("REGEX"),
      "copy the topics of the input whose whole name matches; '.*' for all")(
      "namespace", po::value(&o->output_namespace)->value_name("NS"),
      "name space of the output topics; that of the cameras if not given")(
      "compression", po::value(&o->compression)->default_value(o->compression),
      "of the output: none, lz4 or bz2")(
      "timing", po::bool_switch(&o->timing),
      "write the processing time of each frame; two runs then differ in it")(
      "force", po::bool_switch(&o->force), "overwrite files that exist");
  return options;
}

po::options_description inputOptions(Options* o) {
  po::options_description options("input");
  options.add_options()("rectify", po::value(&o->rectify)->default_value(o->rectify),
                        "auto: raw images, seen by name and calibration; yes; no")(
      "recover", po::bool_switch(&o->recover), "of a damaged bag, process what can be read")(
      "params", po::value(&o->params)->value_name("FILE"),
      "the node's parameters as YAML, as in config/; the options below win");
  return options;
}

/// One option per parameter of the node that counts offline; the values are taken as YAML.
po::options_description parameterOptions(Options* o) {
  po::options_description options("parameters of the node (their defaults: see the README)");
  const NodeConfig defaults;
  visitAllParameters(defaults, [&](const char* parameter, const auto&) {
    const std::string help = parameterHelp(parameter);
    if (help.rfind("live only", 0) == 0) return;
    const auto store = [o, parameter](const std::string& text) {
      o->values[parameter] = parseParameterOption(parameter, text);
    };
    options.add_options()(optionName(parameter).c_str(),
                          po::value<std::string>()->value_name("VALUE")->notifier(store),
                          help.c_str());
  });
  return options;
}

bool readOptions(int argc, char** argv, Options* o) {
  const ToolHelp help{kTool, "IN.bag --output OUT.bag [options]",
                      "Processes a recorded flight exactly as the nodelet would in the air, but "
                      "every frame and as\n"
                      "fast as the machine goes. Needs no ROS master.",
                      "  process_bag flight.bag --output disparity.bag --csv states.csv\n"
                      "  process_bag raw.bag --output all.bag --pass-through '.*' --depth --params "
                      "config/mavros.yaml\n"};
  po::options_description all;
  all.add(outputOptions(o)).add(inputOptions(o));
  all.add(imageTopicOptions(&o->topics)).add(motionTopicOptions(&o->topics));
  all.add(parameterOptions(o));
  po::variables_map values;
  if (!parseCommandLine(argc, argv, help, all, {"input"}, &values)) return false;
  if (values.count("input") == 0)
    throw UsageError("a bag is needed: process_bag IN.bag --output OUT.bag");
  o->input = values["input"].as<std::string>();
  if (o->output.empty()) throw UsageError("--output OUT.bag is missing");
  return true;
}

RectifyMode rectifyMode(const std::string& name) {
  if (name == "auto") return RectifyMode::kAuto;
  if (name == "yes") return RectifyMode::kYes;
  if (name == "no") return RectifyMode::kNo;
  throw UsageError("--rectify '" + name + "': expected auto, yes or no");
}

rosbag::CompressionType compressionType(const std::string& name) {
  if (name == "none") return rosbag::compression::Uncompressed;
  if (name == "lz4") return rosbag::compression::LZ4;
  if (name == "bz2") return rosbag::compression::BZ2;
  throw UsageError("--compression '" + name + "': expected none, lz4 or bz2");
}

NodeConfig nodeConfig(const Options& o) {
  ParameterValues values;
  if (!o.params.empty()) values = readYamlParameters(o.params);
  for (const auto& [name, value] : o.values) values[name] = value;
  std::vector<std::string> warnings;
  NodeConfig config = readNodeConfig(values, warnings);
  reportCorrections(kTool, warnings);
  if (config.processor.target_period > 0.0) {
    std::cerr << kTool << ": target_period is left out: there is no deadline offline\n";
    config.processor.target_period = 0.0;
  }
  return config;
}

std::function<bool(const std::string&)> passThrough(const Options& o, const BagJob& job) {
  if (o.pass_through.empty()) return {};
  std::regex filter;
  try {
    filter = std::regex(o.pass_through);
  } catch (const std::regex_error& error) {
    throw UsageError("--pass-through '" + o.pass_through + "': " + error.what());
  }
  // An older result in the input must not mix with the new one.
  std::vector<std::string> ours;
  for (const char* name : {"disparity", "grid_state", "depth", "grid_overlay", "disparity_color"}) {
    ours.push_back(job.output_namespace + "/" + name);
  }
  return [filter, ours](const std::string& topic) {
    return std::find(ours.begin(), ours.end(), topic) == ours.end() &&
           std::regex_match(topic, filter);
  };
}

void printReport(const BagReport& report, const BagReader& input, double seconds) {
  const double recorded = secondsBetween(input.beginTime(), input.endTime());
  for (const auto& [reason, count] : report.reasons) {
    std::cerr << kTool << ": " << count << " times: " << reason << '\n';
  }
  if (report.motion_unknown > 0) {
    std::cerr << kTool << ": motion unknown in " << report.motion_unknown
              << " frames, lastly: " << report.motion_reason << '\n';
  }
  std::cout << report.frames << " of " << report.left_images << " frames in " << fixed(seconds, 1)
            << " s: " << fixed(report.frames / std::max(1e-9, seconds), 1) << " frames/s";
  if (recorded > 0.0) std::cout << ", " << fixed(recorded / seconds, 1) << " times real time";
  std::cout << '\n';
  for (const auto& [state, count] : report.states) {
    std::cout << "  " << state << ": "
              << fixed(100.0 * static_cast<double>(count) / static_cast<double>(report.frames), 1)
              << " %\n";
  }
}

int run(int argc, char** argv) {
  Options o;
  if (!readOptions(argc, argv, &o)) return 0;
  checkDistinct({o.output, o.csv});
  BagJob job;
  job.rectify = rectifyMode(o.rectify);
  job.wanted = o.wanted;
  job.timing = o.timing;
  const rosbag::CompressionType compression = compressionType(o.compression);
  job.config = nodeConfig(o);
  checkWritable(o.output, o.force);
  if (!o.csv.empty()) checkWritable(o.csv, o.force);

  ros::Time::init();
  const auto start = std::chrono::steady_clock::now();
  BagReader input(o.input);
  if (!input.damage().empty()) {
    if (!o.recover) {
      throw std::runtime_error(input.damage() + "; --recover processes what can be read (" +
                               std::to_string(input.messageCount()) + " messages)");
    }
    std::cerr << kTool << ": " << input.damage() << "; going on with " << input.messageCount()
              << " messages\n";
  }
  if (input.messageCount() == 0) throw std::runtime_error(o.input + ": holds no messages");
  std::vector<std::string> notes;
  job.topics = chooseTopics(input.connections(), o.topics, &notes);
  reportCorrections(kTool, notes);
  job.output_namespace = o.output_namespace.empty() ? outputNamespace(job.topics.left_image)
                                                    : checkedNamespace(o.output_namespace);
  job.pass_through = passThrough(o, job);

  OutputFile bag_file(o.output, o.force);
  rosbag::Bag output(bag_file.writePath(), rosbag::bagmode::Write);
  output.setCompression(compression);
  std::ostringstream csv;
  ProgressBar progress("frames", static_cast<long>(input.messageCount(job.topics.left_image)));
  const BagReport report = processBag(&input, job, &output, o.csv.empty() ? nullptr : &csv,
                                      [&](long done) { progress.update(done); });
  progress.finish();
  output.close();
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  printReport(report, input, seconds.count());
  if (report.damaged > 0 && !o.recover) {
    throw std::runtime_error(o.input + ": " + std::to_string(report.damaged) +
                             " messages are damaged; --recover keeps the others' results");
  }
  if (report.frames == 0) {
    throw std::runtime_error(o.input + ": no frame could be processed, nothing is written");
  }
  if (!o.csv.empty()) writeFile(o.csv, csv.str(), o.force);
  bag_file.commit();
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(kTool, [&] { return run(argc, argv); });
}
