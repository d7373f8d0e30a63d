#include "adaptive_grid_stereo/ros/parameters.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <sstream>
#include <stdexcept>

namespace adaptive_grid_stereo {
namespace {

using XmlRpc::XmlRpcValue;

/// Names of stereo_image_proc/disparity whose meaning has no match here.
const std::set<std::string> kOnlySgbm = {"P1",
                                         "P2",
                                         "fullDP",
                                         "prefilter_size",
                                         "prefilter_cap",
                                         "correlation_window_size",
                                         "stereo_algorithm",
                                         "texture_threshold",
                                         "downsampling_factor",
                                         "sgbm_mode"};

/// Names that other code reads in our private name space.
const std::set<std::string> kForeign = {"diagnostic_period", "num_worker_threads", "compressed",
                                        "theora", "compressedDepth"};

std::string text(bool value) { return value ? "true" : "false"; }
std::string text(int value) { return std::to_string(value); }
std::string text(double value) {
  std::ostringstream stream;
  stream << value;
  return stream.str();
}
std::string text(const std::string& value) { return "\"" + value + "\""; }
std::string text(CensusWindow value) { return text(std::string(toString(value))); }
std::string text(VelocityAxes value) { return text(std::string(toString(value))); }
std::string text(RateAxes value) { return text(std::string(toString(value))); }
std::string text(const std::array<double, 3>& value) {
  return "[" + text(value[0]) + ", " + text(value[1]) + ", " + text(value[2]) + "]";
}

/// Takes raw values into members; each overload throws std::invalid_argument with what it expected.
void take(XmlRpcValue raw, bool& value) {
  if (raw.getType() == XmlRpcValue::TypeBoolean) {
    value = static_cast<bool>(raw);
  } else if (raw.getType() == XmlRpcValue::TypeInt) {
    value = static_cast<int>(raw) != 0;
  } else {
    throw std::invalid_argument("true or false");
  }
}

void take(XmlRpcValue raw, double& value) {
  if (raw.getType() == XmlRpcValue::TypeDouble) {
    value = static_cast<double>(raw);
  } else if (raw.getType() == XmlRpcValue::TypeInt) {
    value = static_cast<int>(raw);
  } else {
    throw std::invalid_argument("a number");
  }
}

void take(XmlRpcValue raw, int& value) {
  double number = 0.0;
  try {
    take(raw, number);
  } catch (const std::invalid_argument&) {
    throw std::invalid_argument("a whole number");
  }
  if (!(std::abs(number) < 1e9) || number != std::floor(number)) {
    throw std::invalid_argument("a whole number");
  }
  value = static_cast<int>(number);
}

void take(XmlRpcValue raw, std::string& value) {
  if (raw.getType() != XmlRpcValue::TypeString) throw std::invalid_argument("a string");
  value = static_cast<std::string>(raw);
}

void take(XmlRpcValue raw, std::array<double, 3>& value) {
  if (raw.getType() != XmlRpcValue::TypeArray || raw.size() != 3) {
    throw std::invalid_argument("a list of three numbers");
  }
  std::array<double, 3> taken{};
  for (int i = 0; i < 3; ++i) take(raw[i], taken[i]);
  value = taken;
}

template <typename Enum, typename Parser>
void takeEnum(const XmlRpcValue& raw, Parser parser, const char* names, Enum& value) {
  std::string name;
  take(raw, name);
  try {
    value = parser(name);
  } catch (const std::invalid_argument&) {
    throw std::invalid_argument(names);  // the caller says the value itself
  }
}
void take(const XmlRpcValue& raw, CensusWindow& value) {
  takeEnum(raw, censusWindowFromString, kCensusWindowNames, value);
}
void take(const XmlRpcValue& raw, VelocityAxes& value) {
  takeEnum(raw, velocityAxesFromString, kVelocityAxesNames, value);
}
void take(const XmlRpcValue& raw, RateAxes& value) {
  takeEnum(raw, rateAxesFromString, kRateAxesNames, value);
}

/// Number of letters to change, add or leave out between two names.
std::size_t editDistance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replace = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replace, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

std::string closest(const std::string& name, const std::set<std::string>& known) {
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(2, name.size() / 3);
  for (const std::string& candidate : known) {
    const std::size_t distance = editDistance(name, candidate);
    if (distance <= best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

void warnOfForeignNames(const ParameterValues& values, const std::set<std::string>& known,
                        std::vector<std::string>& warnings) {
  std::string ignored;
  for (const auto& [name, value] : values) {
    if (known.count(name) != 0 || kForeign.count(name) != 0) continue;
    if (kOnlySgbm.count(name) != 0) {
      ignored += (ignored.empty() ? "" : ", ") + name;
      continue;
    }
    const std::string guess = closest(name, known);
    warnings.push_back("unknown parameter ~" + name + " is ignored" +
                       (guess.empty() ? "" : "; did you mean ~" + guess + "?"));
  }
  if (!ignored.empty()) {
    warnings.push_back("ignored, since they belong to block matching or SGBM: " + ignored +
                       "; see penalty_small, penalty_large and census_window");
  }
}

/// Brings a number into its range, NaN to its lower end, and says so.
template <typename T>
void limit(const char* name, T low, T high, T& value, std::vector<std::string>& changes) {
  const T used = value >= low ? std::min(value, high) : low;
  if (used == value) return;
  changes.push_back(std::string(name) + ": " + text(value) + " -> " + text(used) +
                    " (legal range " + text(low) + ".." + text(high) + ")");
  value = used;
}

/// The one list of what can be changed at run time; `copy` sets its first argument from its second,
/// or the other way round.
template <typename Reconfigure, typename Config, typename Copy>
void pairReconfigure(Reconfigure& to, Config& from, Copy copy) {
  copy(to.min_disparity, from.matcher.min_disparity);
  copy(to.disparity_range, from.matcher.disparity_range);
  copy(to.census_window, from.matcher.census_window);
  copy(to.penalty_small, from.matcher.penalty_small);
  copy(to.penalty_large, from.matcher.penalty_large);
  copy(to.penalty_large_min, from.matcher.penalty_large_min);
  copy(to.adaptive_penalty, from.matcher.adaptive_penalty);
  copy(to.uniqueness_ratio, from.matcher.uniqueness_ratio);
  copy(to.disp12MaxDiff, from.matcher.disp12_max_diff);
  copy(to.min_contrast, from.matcher.min_contrast);
  copy(to.speckle_size, from.matcher.speckle_size);
  copy(to.speckle_range, from.matcher.speckle_range);
  copy(to.subpixel, from.matcher.subpixel);
  copy(to.median_filter, from.matcher.median_filter);
  copy(to.threads, from.matcher.threads);
  copy(to.lock_speed, from.guidance.lock_speed);
  copy(to.max_speed, from.guidance.max_speed);
  copy(to.max_yaw_rate, from.guidance.max_yaw_rate);
  copy(to.max_pitch_rate, from.guidance.max_pitch_rate);
  copy(to.sigma1, from.guidance.sigma1);
  copy(to.sigma2, from.guidance.sigma2);
  copy(to.hysteresis, from.guidance.hysteresis);
  copy(to.min_dwell_time, from.guidance.min_dwell_time);
  copy(to.grid_gain, from.guidance.grid_gain);
  copy(to.center_min_fraction, from.guidance.center_min_fraction);
  copy(to.paths_focus, from.guidance.paths_focus);
  copy(to.paths_near, from.guidance.paths_near);
  copy(to.paths_far, from.guidance.paths_far);
  copy(to.paths_unknown, from.guidance.paths_unknown);
  copy(to.target_period, from.target_period);
}

}  // namespace

std::vector<std::string> NodeConfig::validate() {
  std::vector<std::string> changes = processor.validate();
  for (std::string& change : motion.validate()) changes.push_back(std::move(change));
  limit("approximate_sync_max_interval", 0.0, 10.0, approximate_sync_max_interval, changes);
  limit("queue_size", 1, 1000, queue_size, changes);
  limit("baseline", 0.0, 100.0, baseline, changes);
  limit("expected_rate", 0.0, 1000.0, expected_rate, changes);
  limit("min_density", 0.0, 1.0, min_density, changes);
  return changes;
}

NodeConfig readNodeConfig(const ParameterValues& values, std::vector<std::string>& warnings) {
  NodeConfig config;
  std::set<std::string> known;
  visitAllParameters(config, [&](const char* name, auto& member) {
    known.insert(name);
    const auto found = values.find(name);
    if (found == values.end()) return;
    try {
      take(found->second, member);
    } catch (const std::invalid_argument& error) {
      std::ostringstream raw;
      found->second.write(raw);
      warnings.push_back(std::string("~") + name + " is " + raw.str() + ", expected " +
                         error.what() + "; the default " + text(member) + " is used");
    }
  });
  warnOfForeignNames(values, known, warnings);
  for (std::string& change : config.validate()) warnings.push_back("~" + std::move(change));
  if (config.approximate_sync && config.queue_size < 2) {
    warnings.push_back("~queue_size 1 with approximate_sync: at least 2 is recommended");
  }
  return config;
}

std::string expectedInstead(const std::string& name, const XmlRpcValue& value) {
  std::string expected;
  NodeConfig config;
  visitAllParameters(config, [&](const char* parameter, auto& member) {
    if (name != parameter) return;
    try {
      take(value, member);
    } catch (const std::invalid_argument& error) {
      expected = error.what();
    }
  });
  return expected;
}

ParameterValues privateParameters(const ros::NodeHandle& private_handle) {
  ParameterValues values;
  XmlRpcValue tree;
  if (!private_handle.getParam(private_handle.getNamespace(), tree) ||
      tree.getType() != XmlRpcValue::TypeStruct) {
    return values;
  }
  for (auto& [name, value] : tree) values[name] = value;
  return values;
}

std::string toString(const NodeConfig& config) {
  std::string all;
  visitAllParameters(config, [&](const char* name, const auto& member) {
    all += (all.empty() ? "" : ", ") + std::string(name) + ": " + text(member);
  });
  return all;
}

DisparityConfig toReconfigure(const ProcessorConfig& config) {
  DisparityConfig reconfigure = DisparityConfig::__getDefault__();
  pairReconfigure(reconfigure, config, [](auto& to, const auto& from) {
    if constexpr (std::is_same_v<std::decay_t<decltype(from)>, CensusWindow>) {
      to = toString(from);
    } else {
      to = from;
    }
  });
  return reconfigure;
}

ProcessorConfig fromReconfigure(const DisparityConfig& reconfigure, const ProcessorConfig& before,
                                std::vector<std::string>& warnings) {
  ProcessorConfig config = before;
  pairReconfigure(reconfigure, config, [&](const auto& from, auto& to) {
    if constexpr (std::is_same_v<std::decay_t<decltype(to)>, CensusWindow>) {
      try {
        to = censusWindowFromString(from);
      } catch (const std::invalid_argument& error) {
        warnings.push_back(std::string(error.what()) + "; " + toString(to) + " stays");
      }
    } else {
      to = from;
    }
  });
  for (std::string& change : config.validate()) warnings.push_back(std::move(change));
  return config;
}

}  // namespace adaptive_grid_stereo
