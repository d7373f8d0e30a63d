// Defaults and ranges stand in the structs; the .cfg, config/default.yaml and the README repeat
// them.

#include "adaptive_grid_stereo/ros/parameters.h"

#include <cctype>
#include <cmath>
#include <fstream>
#include <set>

#include <gtest/gtest.h>

namespace adaptive_grid_stereo {
namespace {

using XmlRpc::XmlRpcValue;

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" `\t");
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(" `\t\r") - first + 1);
}

/// One scalar or list of numbers, as YAML would read it.
XmlRpcValue parseScalar(std::string text) {
  text = trimmed(text);
  if (text == "true" || text == "false") return XmlRpcValue(text == "true");
  if (!text.empty() && text.front() == '[') {
    XmlRpcValue list;
    std::stringstream numbers(text.substr(1));
    double number = 0.0;
    for (int i = 0; numbers >> number; ++i, numbers.ignore()) list[i] = number;
    return list;
  }
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  if (!text.empty() && *end == '\0') {
    if (text.find_first_of(".e") == std::string::npos) {
      return XmlRpcValue(static_cast<int>(number));
    }
    return XmlRpcValue(number);
  }
  if (text.size() >= 2 && text.front() == '"') text = text.substr(1, text.size() - 2);
  return XmlRpcValue(text);
}

/// The flat "name: value" lines of one of our YAML files.
ParameterValues readYaml(const std::string& name) {
  std::ifstream file(std::string(AGS_SOURCE_DIR) + "/config/" + name);
  EXPECT_TRUE(file) << name;
  ParameterValues values;
  for (std::string line; std::getline(file, line);) {
    line = line.substr(0, line.find('#'));
    const auto colon = line.find(':');
    if (colon == std::string::npos) continue;
    values[trimmed(line.substr(0, colon))] = parseScalar(line.substr(colon + 1));
  }
  return values;
}

std::set<std::string> allNames() {
  std::set<std::string> names;
  NodeConfig config;
  visitAllParameters(config, [&](const char* name, auto&) { names.insert(name); });
  return names;
}

TEST(DefaultYaml, HoldsEveryParameterWithItsDefault) {
  const ParameterValues values = readYaml("default.yaml");
  for (const std::string& name : allNames()) EXPECT_EQ(values.count(name), 1U) << name;
  std::vector<std::string> warnings;
  const NodeConfig read = readNodeConfig(values, warnings);
  EXPECT_TRUE(warnings.empty()) << warnings.front();
  EXPECT_EQ(toString(read), toString(NodeConfig()));
}

TEST(PaperYaml, IsReadWithoutComplaint) {
  std::vector<std::string> warnings;
  const NodeConfig read = readNodeConfig(readYaml("paper.yaml"), warnings);
  EXPECT_TRUE(warnings.empty()) << warnings.front();
  EXPECT_NEAR(read.processor.guidance.max_yaw_rate, 10.0 * 2.0 * M_PI, 1e-9);
  EXPECT_NEAR(read.processor.guidance.max_pitch_rate, 8.0 * 2.0 * M_PI, 1e-9);
}

TEST(Cfg, HasTheDefaultsOfTheStructs) {
  const DisparityConfig from_cfg = DisparityConfig::__getDefault__();
  std::vector<std::string> warnings;
  NodeConfig config;
  config.processor = fromReconfigure(from_cfg, ProcessorConfig(), warnings);
  EXPECT_TRUE(warnings.empty()) << warnings.front();
  // The .cfg writes 1/3 in decimals of its own.
  EXPECT_NEAR(config.processor.guidance.center_min_fraction, 1.0 / 3.0, 1e-9);
  config.processor.guidance.center_min_fraction = GuidanceConfig().center_min_fraction;
  EXPECT_EQ(toString(config), toString(NodeConfig()));
}

TEST(Cfg, HasEveryMatchingAndGuidanceParameter) {
  dynamic_reconfigure::Config message;
  DisparityConfig::__getDefault__().__toMessage__(message);
  std::set<std::string> names;
  for (const auto& parameter : message.ints) names.insert(parameter.name);
  for (const auto& parameter : message.doubles) names.insert(parameter.name);
  for (const auto& parameter : message.bools) names.insert(parameter.name);
  for (const auto& parameter : message.strs) names.insert(parameter.name);
  std::set<std::string> expected = {"target_period"};
  const auto collect = [&](const char* name, auto&) { expected.insert(name); };
  ProcessorConfig config;
  visitMatcherParameters(config.matcher, collect);
  visitGuidanceParameters(config.guidance, collect);
  EXPECT_EQ(names, expected);
}

/// Whether validate() leaves a value as it is, with everything else at its default.
bool isLegal(const std::string& name, double value) {
  ProcessorConfig config;
  // Limits that depend on each other are tested one at a time.
  if (name == "penalty_small") config.matcher.penalty_large_min = kLargestPenalty;
  if (name == "penalty_large_min") config.matcher.penalty_small = 0;
  if (name == "penalty_large") config.matcher.penalty_small = 0;
  if (name == "paths_focus") config.guidance.paths_near = config.guidance.paths_far = 4;
  if (name == "paths_near") config.guidance.paths_far = 4;
  if (name == "paths_far") config.guidance.paths_near = 16;
  double after = value;
  const auto set = [&](const char* candidate, auto& member) {
    using T = std::decay_t<decltype(member)>;
    if constexpr (std::is_arithmetic_v<T>) {
      if (name == candidate) member = static_cast<T>(value);
    }
  };
  const auto get = [&](const char* candidate, auto& member) {
    using T = std::decay_t<decltype(member)>;
    if constexpr (std::is_arithmetic_v<T>) {
      if (name == candidate) after = static_cast<double>(member);
    }
  };
  const auto visit = [&](auto visitor) {
    visitMatcherParameters(config.matcher, visitor);
    visitGuidanceParameters(config.guidance, visitor);
    visitor("target_period", config.target_period);
  };
  visit(set);
  config.validate();
  visit(get);
  return after == value;
}

template <typename Parameters>
void compareRanges(const Parameters& lowest, const Parameters& highest, double step) {
  for (std::size_t i = 0; i < lowest.size(); ++i) {
    const std::string& name = lowest[i].name;
    ASSERT_EQ(name, highest[i].name);
    EXPECT_TRUE(isLegal(name, lowest[i].value)) << name << " = " << lowest[i].value;
    EXPECT_TRUE(isLegal(name, highest[i].value)) << name << " = " << highest[i].value;
    EXPECT_FALSE(isLegal(name, lowest[i].value - step)) << name << " below " << lowest[i].value;
    EXPECT_FALSE(isLegal(name, highest[i].value + step)) << name << " above " << highest[i].value;
  }
}

TEST(Cfg, HasTheRangesOfValidate) {
  dynamic_reconfigure::Config lowest;
  dynamic_reconfigure::Config highest;
  DisparityConfig::__getMin__().__toMessage__(lowest);
  DisparityConfig::__getMax__().__toMessage__(highest);
  ASSERT_EQ(lowest.ints.size(), highest.ints.size());
  ASSERT_GT(lowest.ints.size(), 5U);
  ASSERT_GT(lowest.doubles.size(), 5U);
  compareRanges(lowest.ints, highest.ints, 1.0);
  compareRanges(lowest.doubles, highest.doubles, 0.001);
}

TEST(Readme, TableHasTheDefaults) {
  std::ifstream file(std::string(AGS_SOURCE_DIR) + "/README.md");
  if (!file) GTEST_SKIP() << "there is no README.md";
  ParameterValues values;
  const std::set<std::string> names = allNames();
  for (std::string line; std::getline(file, line);) {
    // | `name` | default | ...
    if (line.rfind("| `", 0) != 0) continue;
    std::stringstream cells(line.substr(1));
    std::string name, value;
    std::getline(cells, name, '|');
    std::getline(cells, value, '|');
    if (names.count(trimmed(name)) == 0) continue;
    values[trimmed(name)] = trimmed(value) == "1/3" ? XmlRpcValue(1.0 / 3.0) : parseScalar(value);
  }
  if (values.empty()) GTEST_SKIP() << "README.md has no parameter table";
  for (const std::string& name : names) EXPECT_EQ(values.count(name), 1U) << name;
  std::vector<std::string> warnings;
  const NodeConfig read = readNodeConfig(values, warnings);
  EXPECT_TRUE(warnings.empty()) << warnings.front();
  EXPECT_EQ(toString(read), toString(NodeConfig()));
}

/// The only warning for one raw value.
std::string warningOf(const std::string& name, const XmlRpcValue& value, NodeConfig& config) {
  std::vector<std::string> warnings;
  config = readNodeConfig({{name, value}}, warnings);
  EXPECT_EQ(warnings.size(), 1U);
  return warnings.empty() ? "" : warnings.front();
}

TEST(ReadNodeConfig, TakesValuesOfEveryType) {
  std::vector<std::string> warnings;
  XmlRpcValue rpy;
  rpy[0] = 0.1;
  rpy[1] = 0;
  rpy[2] = -0.3;
  const NodeConfig config = readNodeConfig({{"disparity_range", XmlRpcValue(128)},
                                            {"uniqueness_ratio", XmlRpcValue(7)},
                                            {"min_disparity", XmlRpcValue(-16.0)},
                                            {"approximate_sync", XmlRpcValue(true)},
                                            {"subpixel", XmlRpcValue(0)},
                                            {"census_window", XmlRpcValue("5x5")},
                                            {"velocity_axes", XmlRpcValue("ned")},
                                            {"camera_rpy", rpy},
                                            {"image_transport", XmlRpcValue("compressed")}},
                                           warnings);
  EXPECT_TRUE(warnings.empty()) << warnings.front();
  EXPECT_EQ(config.processor.matcher.disparity_range, 128);
  EXPECT_DOUBLE_EQ(config.processor.matcher.uniqueness_ratio, 7.0);
  EXPECT_EQ(config.processor.matcher.min_disparity, -16);
  EXPECT_TRUE(config.approximate_sync);
  EXPECT_FALSE(config.processor.matcher.subpixel);
  EXPECT_EQ(config.processor.matcher.census_window, CensusWindow::k5x5);
  EXPECT_EQ(config.motion.velocity_axes, VelocityAxes::kNed);
  EXPECT_DOUBLE_EQ(config.motion.camera_rpy[2], -0.3);
  EXPECT_EQ(config.image_transport, "compressed");
}

TEST(ReadNodeConfig, SaysFromAndToOfARangeCorrection) {
  NodeConfig config;
  const std::string warning = warningOf("disparity_range", XmlRpcValue(100), config);
  EXPECT_EQ(config.processor.matcher.disparity_range, 112);
  EXPECT_NE(warning.find("disparity_range"), std::string::npos) << warning;
  EXPECT_NE(warning.find("100"), std::string::npos) << warning;
  EXPECT_NE(warning.find("112"), std::string::npos) << warning;
  warningOf("queue_size", XmlRpcValue(0), config);
  EXPECT_EQ(config.queue_size, 1);
  warningOf("baseline", XmlRpcValue(std::nan("")), config);
  EXPECT_EQ(config.baseline, 0.0);
}

TEST(ReadNodeConfig, KeepsTheDefaultForAWrongType) {
  NodeConfig config;
  const std::string warning = warningOf("disparity_range", XmlRpcValue("many"), config);
  EXPECT_EQ(config.processor.matcher.disparity_range, 64);
  EXPECT_NE(warning.find("many"), std::string::npos) << warning;
  EXPECT_NE(warning.find("64"), std::string::npos) << warning;
  warningOf("disparity_range", XmlRpcValue(64.5), config);
  warningOf("census_window", XmlRpcValue("4x4"), config);
  EXPECT_EQ(config.processor.matcher.census_window, CensusWindow::k9x7);
  const std::string axes = warningOf("velocity_axes", XmlRpcValue("nwu"), config);
  EXPECT_NE(
      axes.find("~velocity_axes is nwu, expected body_flu, body_frd, enu or ned; the default"),
      std::string::npos)
      << axes;
  warningOf("camera_rpy", XmlRpcValue(1.0), config);
  warningOf("lazy", XmlRpcValue("yes"), config);
  EXPECT_TRUE(config.lazy);
}

TEST(ReadNodeConfig, WarnsOfUnknownNamesWithAGuess) {
  NodeConfig config;
  const std::string typo = warningOf("disparty_range", XmlRpcValue(128), config);
  EXPECT_NE(typo.find("disparty_range"), std::string::npos) << typo;
  EXPECT_NE(typo.find("did you mean ~disparity_range?"), std::string::npos) << typo;
  const std::string strange = warningOf("zzzzzzzzzz", XmlRpcValue(1), config);
  EXPECT_EQ(strange.find("did you mean"), std::string::npos) << strange;
}

TEST(ReadNodeConfig, NamesSgbmsOwnParametersOnceAsIgnored) {
  std::vector<std::string> warnings;
  readNodeConfig({{"P1", XmlRpcValue(200.0)},
                  {"P2", XmlRpcValue(400.0)},
                  {"prefilter_cap", XmlRpcValue(31)},
                  {"fullDP", XmlRpcValue(false)},
                  {"stereo_algorithm", XmlRpcValue(1)},
                  {"diagnostic_period", XmlRpcValue(1.0)}},
                 warnings);
  ASSERT_EQ(warnings.size(), 1U);
  for (const char* name : {"P1", "P2", "prefilter_cap", "fullDP", "stereo_algorithm"}) {
    EXPECT_NE(warnings[0].find(name), std::string::npos) << warnings[0];
  }
  EXPECT_EQ(warnings[0].find("diagnostic_period"), std::string::npos) << warnings[0];
}

TEST(Reconfigure, GoesThereAndBack) {
  ProcessorConfig config;
  config.matcher.census_window = CensusWindow::k7x7;
  config.matcher.disparity_range = 96;
  config.guidance.sigma1 = 0.55;
  config.guidance.paths_unknown = 16;
  config.target_period = 0.05;
  std::vector<std::string> warnings;
  NodeConfig before;
  before.processor = config;
  NodeConfig after;
  after.processor = fromReconfigure(toReconfigure(config), ProcessorConfig(), warnings);
  EXPECT_TRUE(warnings.empty());
  EXPECT_EQ(toString(after), toString(before));
}

TEST(Reconfigure, CorrectsAndSaysSo) {
  DisparityConfig reconfigure = toReconfigure(ProcessorConfig());
  reconfigure.disparity_range = 50;
  reconfigure.paths_focus = 11;
  reconfigure.census_window = "3x3";
  std::vector<std::string> warnings;
  const ProcessorConfig config = fromReconfigure(reconfigure, ProcessorConfig(), warnings);
  EXPECT_EQ(config.matcher.disparity_range, 64);
  EXPECT_EQ(config.guidance.paths_focus, 8);
  EXPECT_EQ(config.matcher.census_window, CensusWindow::k9x7);
  EXPECT_EQ(warnings.size(), 3U);
}

}  // namespace
}  // namespace adaptive_grid_stereo
