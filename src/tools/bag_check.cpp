// bag_check BAG: says before a flight what is wrong with a log or a rig.

#include <algorithm>
#include <iostream>

#include <ros/time.h>

#include "bag_check.h"
#include "command_line.h"

namespace adaptive_grid_stereo {
namespace {

constexpr const char* kTool = "bag_check";

struct Options {
  std::string bag;
  std::string optical_frame;
  double baseline = 0.0;
  NamedTopics topics;
  MotionConfig motion;
};

void addMotionFindings(BagReader* bag, const Options& options, std::vector<Finding>* findings) {
  std::vector<std::string> notes;
  const MotionTopics topics = chooseMotionTopics(bag->connections(), options.topics, &notes);
  for (const std::string& note : notes) {
    findings->push_back({Verdict::kWarning, "motion topics", note});
  }
  for (const Finding& finding : checkMotion(bag, topics, options.motion, options.optical_frame)) {
    findings->push_back(finding);
  }
}

int run(const Options& options) {
  BagReader bag(options.bag);
  std::vector<Finding> findings;
  if (bag.messageCount() == 0) {
    findings.push_back({Verdict::kError, "bag", "it holds no messages"});
  } else {
    findings = checkImages(&bag, options.topics, options.baseline);
    addMotionFindings(&bag, options, &findings);
  }
  if (!bag.damage().empty()) findings.push_back({Verdict::kError, "bag", bag.damage()});

  long errors = 0, warnings = 0;
  for (const Finding& finding : findings) {
    const char* word = finding.verdict == Verdict::kError     ? "ERROR"
                       : finding.verdict == Verdict::kWarning ? "WARN "
                                                              : "OK   ";
    std::cout << word << "  " << finding.subject << ": " << finding.text << "\n";
    errors += finding.verdict == Verdict::kError;
    warnings += finding.verdict == Verdict::kWarning;
  }
  std::cout << options.bag << ": " << errors << " errors, " << warnings << " warnings\n";
  return errors > 0 ? 1 : 0;
}

int parseAndRun(int argc, const char* const* argv) {
  namespace po = boost::program_options;
  ros::Time::init();
  Options options;
  po::options_description own("Options");
  own.add_options()  //
      ("optical-frame", po::value(&options.optical_frame),
       "frame of the left camera, where the bag holds its TF")  //
      ("baseline", po::value(&options.baseline)->default_value(0.0),
       "as the node's parameter [m]; 0: by camera_info");
  own.add(imageTopicOptions(&options.topics))
      .add(motionTopicOptions(&options.topics))
      .add(motionOptions(&options.motion));
  const ToolHelp help = {
      kTool, "BAG [options]",
      "Checks stereo pairs, calibration and motion of a recording, and whether the declared axes "
      "contradict each other; exit code 0: no ERROR (there may be WARNs), 1: an ERROR.",
      "rosrun adaptive_grid_stereo bag_check flight.bag --velocity-axes enu"};
  po::variables_map values;
  if (!parseCommandLine(argc, argv, help, own, {"bag"}, &values)) return 0;
  if (values.count("bag") == 0) throw UsageError("a bag is needed: bag_check BAG");
  options.bag = values["bag"].as<std::string>();
  if (!(options.baseline >= 0.0 && options.baseline <= 100.0)) {
    throw UsageError("--baseline " + std::to_string(options.baseline) + ": expected 0 to 100 m");
  }
  reportCorrections(kTool, options.motion.validate());
  return run(options);
}

}  // namespace
}  // namespace adaptive_grid_stereo

int main(int argc, char** argv) {
  return adaptive_grid_stereo::runTool(
      adaptive_grid_stereo::kTool, [&] { return adaptive_grid_stereo::parseAndRun(argc, argv); });
}
