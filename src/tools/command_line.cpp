#include "command_line.h"

#include <array>
#include <exception>
#include <iostream>
#include <sstream>

#include <opencv2/core/utils/logger.hpp>

namespace po = boost::program_options;

namespace adaptive_grid_stereo {
namespace {

std::string shortNumber(double value) {
  std::ostringstream text;
  text.precision(4);
  text << value;
  return text.str();
}

po::typed_value<int>* integer(int* target) {
  return po::value<int>(target)->default_value(*target)->value_name("N");
}

po::typed_value<double>* number(double* target) {
  return po::value<double>(target)->default_value(*target, shortNumber(*target))->value_name("X");
}

po::typed_value<bool>* flag(bool* target) {
  return po::value<bool>(target)
      ->default_value(*target, *target ? "true" : "false")
      ->value_name("true|false");
}

/// An option that is a word; `apply` turns it into the config's value and may throw.
po::typed_value<std::string>* word(const std::string& standing, const std::string& legal,
                                   const std::function<void(const std::string&)>& apply) {
  return po::value<std::string>()->default_value(standing)->value_name(legal)->notifier(apply);
}

void printHelp(const ToolHelp& help, const po::options_description& options) {
  std::cout << "usage: " << help.name << ' ' << help.arguments << "\n\n"
            << help.purpose << "\n\n"
            << options;
  if (!help.examples.empty()) std::cout << "\nexamples:\n" << help.examples;
}

}  // namespace

po::options_description matcherOptions(MatcherConfig* c) {
  po::options_description options("matching parameters");
  const auto setWindow = [c](const std::string& name) {
    c->census_window = censusWindowFromString(name);
  };
  options.add_options()("min-disparity", integer(&c->min_disparity),
                        "smallest disparity searched [px]")(
      "disparity-range", integer(&c->disparity_range), "disparities searched, a multiple of 16")(
      "census-window", word(toString(c->census_window), "5x5|7x7|9x7", setWindow),
      "census window [px]")("penalty-small", integer(&c->penalty_small), "P1 [Hamming bits]")(
      "penalty-large", integer(&c->penalty_large), "P2', divided by the grey-level step")(
      "penalty-large-min", integer(&c->penalty_large_min), "lower limit of P2 [Hamming bits]")(
      "adaptive-penalty", flag(&c->adaptive_penalty), "divide P2' by the grey-level step")(
      "uniqueness-ratio", number(&c->uniqueness_ratio), "lead of the winner [%]")(
      "disp12-max-diff", integer(&c->disp12_max_diff),
      "left-right difference allowed [px]; negative: no check")(
      "disp12MaxDiff", po::value<int>(&c->disp12_max_diff)->value_name("N"),
      "the same under its ROS name")("speckle-size", integer(&c->speckle_size),
                                     "regions up to this size are removed [px]; 0: none")(
      "speckle-range", integer(&c->speckle_range), "disparity step inside a region [px]")(
      "subpixel", flag(&c->subpixel), "quadratic sub-pixel interpolation")(
      "median-filter", flag(&c->median_filter), "3x3 median of the valid disparities")(
      "threads", integer(&c->threads), "worker threads; 0: one per core");
  return options;
}

po::options_description guidanceOptions(GuidanceConfig* c) {
  po::options_description options("guidance parameters");
  options.add_options()("lock-speed", number(&c->lock_speed), "LOCKED up to this speed [m/s]")(
      "max-speed", number(&c->max_speed), "V_max [m/s]")("max-yaw-rate", number(&c->max_yaw_rate),
                                                         "Y_max [rad/s]")(
      "max-pitch-rate", number(&c->max_pitch_rate), "P_max [rad/s]")(
      "sigma1", number(&c->sigma1), "YAW from this share of Y_max")(
      "sigma2", number(&c->sigma2), "PITCH from this share of P_max")(
      "hysteresis", number(&c->hysteresis), "a state is left below this share of its threshold")(
      "min-dwell-time", number(&c->min_dwell_time), "a state is held so long [s]")(
      "grid-gain", number(&c->grid_gain), "g of w = W - g (v / V_max) W")(
      "center-min-fraction", number(&c->center_min_fraction), "smallest centre cell, as a share")(
      "paths-focus", integer(&c->paths_focus), "paths in the focus: 16, 8 or 4")(
      "paths-near", integer(&c->paths_near), "paths next to it")(
      "paths-far", integer(&c->paths_far), "paths farther away")(
      "paths-unknown", integer(&c->paths_unknown), "paths while the motion is unknown");
  return options;
}

po::options_description motionOptions(MotionConfig* c) {
  po::options_description options("motion parameters");
  options.add_options()("speed-source",
                        po::value<std::string>(&c->speed_source)->default_value(c->speed_source),
                        "auto, odom, gps_vel or gps_fix")(
      "rate-source", po::value<std::string>(&c->rate_source)->default_value(c->rate_source),
      "auto, imu or odom")(
      "velocity-axes",
      word(toString(c->velocity_axes), "AXES",
           [c](const std::string& name) { c->velocity_axes = velocityAxesFromString(name); }),
      "axes of velocities: body_flu, body_frd, enu or ned")(
      "rate-axes",
      word(toString(c->rate_axes), "AXES",
           [c](const std::string& name) { c->rate_axes = rateAxesFromString(name); }),
      "axes of angular rates: body_flu or body_frd")(
      "camera-roll", number(&c->camera_rpy[0]), "camera against body where TF has nothing [rad]")(
      "camera-pitch", number(&c->camera_rpy[1]), "likewise")("camera-yaw",
                                                             number(&c->camera_rpy[2]), "likewise")(
      "motion-delay", number(&c->motion_delay), "offset from camera to motion stamps [s]")(
      "motion-timeout", number(&c->motion_timeout), "older samples are stale [s]")(
      "rate-filter-time", number(&c->rate_filter_time), "low-pass of the rates [s]; 0: none");
  return options;
}

bool parseCommandLine(int argc, const char* const* argv, const ToolHelp& help,
                      const po::options_description& options,
                      const std::vector<std::string>& positional, po::variables_map* values) {
  po::options_description all = options;
  all.add_options()("help,h", "show this help")("version", "show the version");
  po::positional_options_description positions;
  for (std::size_t i = 0; i < positional.size(); ++i) {
    // The last one takes all that follow only if its name says so.
    const bool many = positional[i].back() == '*';
    const std::string name =
        many ? positional[i].substr(0, positional[i].size() - 1) : positional[i];
    all.add_options()(name.c_str(),
                      many ? static_cast<po::value_semantic*>(po::value<std::vector<std::string>>())
                           : po::value<std::string>());
    positions.add(name.c_str(), many ? -1 : 1);
  }
  try {
    const int style = po::command_line_style::unix_style & ~po::command_line_style::allow_guessing;
    po::store(
        po::command_line_parser(argc, argv).options(all).positional(positions).style(style).run(),
        *values);
    if (values->count("help") > 0) {
      printHelp(help, options);
      return false;
    }
    if (values->count("version") > 0) {
      std::cout << help.name << " (adaptive_grid_stereo) " << AGS_VERSION << '\n';
      return false;
    }
    po::notify(*values);
  } catch (const po::error& error) {
    throw UsageError(std::string(error.what()) + "; see " + help.name + " --help");
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
  return true;
}

void reportCorrections(const std::string& tool, const std::vector<std::string>& sentences) {
  for (const std::string& sentence : sentences) std::cerr << tool << ": " << sentence << '\n';
}

int runTool(const std::string& tool, const std::function<int()>& body) {
  // OpenCV would add its own lines about files that the tools complain about in words.
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  try {
    return body();
  } catch (const UsageError& error) {
    std::cerr << tool << ": " << error.what() << '\n';
    return 2;
  } catch (const std::exception& error) {
    std::cerr << tool << ": " << error.what() << '\n';
    return 1;
  } catch (...) {
    std::cerr << tool << ": failed for an unknown reason\n";
    return 1;
  }
}

}  // namespace adaptive_grid_stereo
