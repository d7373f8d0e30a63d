#include <cctype>
#include <map>
#include <sstream>

#include "adaptive_grid_stereo/ros/parameter_visitor.h"
#include "command_line.h"

namespace po = boost::program_options;

namespace adaptive_grid_stereo {
namespace {

std::string shortNumber(double value) {
  std::ostringstream text;
  text.precision(4);
  text << value;
  return text.str();
}

po::typed_value<int>* optionFor(int* target) {
  return po::value<int>(target)->default_value(*target)->value_name("N");
}

po::typed_value<double>* optionFor(double* target) {
  return po::value<double>(target)->default_value(*target, shortNumber(*target))->value_name("X");
}

po::typed_value<bool>* optionFor(bool* target) {
  return po::value<bool>(target)
      ->default_value(*target, *target ? "true" : "false")
      ->value_name("true|false");
}

po::typed_value<std::string>* optionFor(CensusWindow* target) {
  return po::value<std::string>()
      ->default_value(toString(*target))
      ->value_name("5x5|7x7|9x7")
      ->notifier([target](const std::string& name) { *target = censusWindowFromString(name); });
}

/// Adds an option per visited parameter.
struct AddOption {
  po::options_description* options;

  template <typename Value>
  void operator()(const char* parameter, Value& value) const {
    const std::string name = optionName(parameter);
    options->add_options()(name.c_str(), optionFor(&value), parameterHelp(parameter).c_str());
  }
};

const std::map<std::string, std::string>& helpTexts() {
  static const std::map<std::string, std::string> texts{
      {"min_disparity", "smallest disparity searched [px]"},
      {"disparity_range", "disparities searched, a multiple of 16"},
      {"census_window", "census window [px]"},
      {"penalty_small", "P1 [Hamming bits]"},
      {"penalty_large", "P2', divided by the grey-level step"},
      {"penalty_large_min", "lower limit of P2 [Hamming bits]"},
      {"adaptive_penalty", "divide P2' by the grey-level step"},
      {"uniqueness_ratio", "lead of the winner [%]"},
      {"disp12MaxDiff", "left-right difference allowed [px]; negative: no check"},
      {"min_contrast", "invalid where the grey levels vary less; 0: no check"},
      {"speckle_size", "regions up to this size are removed [px]; 0: none"},
      {"speckle_range", "disparity step inside a region [px]"},
      {"subpixel", "quadratic sub-pixel interpolation"},
      {"median_filter", "3x3 median of the valid disparities"},
      {"threads", "worker threads; 0: one per core"},
      {"lock_speed", "LOCKED up to this speed [m/s]"},
      {"max_speed", "V_max [m/s]"},
      {"max_yaw_rate", "Y_max [rad/s]"},
      {"max_pitch_rate", "P_max [rad/s]"},
      {"sigma1", "YAW from this share of Y_max"},
      {"sigma2", "PITCH from this share of P_max"},
      {"hysteresis", "a state is left below this share of its threshold"},
      {"min_dwell_time", "a state is held at least so long [s]"},
      {"grid_gain", "g of w = W - g (v / V_max) W"},
      {"center_min_fraction", "smallest centre cell, as a share of the image"},
      {"paths_focus", "paths in the focus: 16, 8 or 4"},
      {"paths_near", "paths next to the focus"},
      {"paths_far", "paths farther away"},
      {"paths_unknown", "paths while the motion is unknown"},
      {"speed_source", "auto, odom, gps_vel or gps_fix"},
      {"rate_source", "auto, imu or odom"},
      {"velocity_axes", "axes of velocities: body_flu, body_frd, enu or ned"},
      {"gps_velocity_axes",
       "axes of the GPS velocity; auto: velocity_axes if enu or ned, else enu"},
      {"rate_axes", "axes of angular rates: body_flu or body_frd"},
      {"tf_axes", "axes of the body frames in TF: body_flu or body_frd"},
      {"body_frame", "frame of the rates, where the messages name a wrong one"},
      {"camera_rpy", "camera against body where TF has nothing, [roll, pitch, yaw] [rad]"},
      {"motion_delay", "offset from camera stamps to motion stamps [s]"},
      {"motion_timeout", "older samples are stale [s]"},
      {"rate_filter_time", "low-pass of the rates [s]; 0: none"},
      {"fix_window", "flight over which position fixes are differenced [s]"},
      {"magnetic_declination", "true to magnetic north, east positive [rad]"},
      {"motion_wait", "live only: longest wait for motion samples [s]"},
      {"approximate_sync", "pair images whose stamps differ"},
      {"approximate_sync_max_interval", "largest difference of their stamps [s]; 0: no limit"},
      {"queue_size", "messages kept while waiting for their partners"},
      {"baseline", "overrides the camera_info's baseline [m]; 0: camera_info"},
      {"image_transport", "live only"},
      {"lazy", "live only"},
      {"process_every_frame", "live only"},
      {"expected_rate", "live only"},
      {"min_density", "live only"},
      {"mono16_bits", "significant bits of 16-bit images; 0: seen from the data"},
      {"target_period", "live only"}};
  return texts;
}

}  // namespace

std::string optionName(const std::string& parameter) {
  std::string name;
  for (const char character : parameter) {
    if (std::isupper(static_cast<unsigned char>(character))) {
      name += '-';
      name += static_cast<char>(std::tolower(static_cast<unsigned char>(character)));
    } else {
      name += character == '_' ? '-' : character;
    }
  }
  return name;
}

std::string parameterHelp(const std::string& parameter) {
  const auto found = helpTexts().find(parameter);
  return found == helpTexts().end() ? "" : found->second;
}

po::options_description matcherOptions(MatcherConfig* config) {
  po::options_description options("matching parameters");
  visitMatcherParameters(*config, AddOption{&options});
  options.add_options()("disp12MaxDiff", po::value<int>(&config->disp12_max_diff)->value_name("N"),
                        "--disp12-max-diff under its ROS name");
  return options;
}

po::options_description guidanceOptions(GuidanceConfig* config) {
  po::options_description options("guidance parameters");
  visitGuidanceParameters(*config, AddOption{&options});
  return options;
}

}  // namespace adaptive_grid_stereo
