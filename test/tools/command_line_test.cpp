#include "command_line.h"

#include <gtest/gtest.h>

#include "adaptive_grid_stereo/ros/parameter_visitor.h"
#include "motion_plan.h"
#include "temporary_folder.h"
#include "text_table.h"

namespace po = boost::program_options;

namespace adaptive_grid_stereo {
namespace {

struct Parsed {
  MatcherConfig matcher;
  GuidanceConfig guidance;
  std::string fault;
};

Parsed parse(std::vector<const char*> arguments) {
  Parsed parsed;
  arguments.insert(arguments.begin(), "tool");
  po::options_description options;
  options.add(matcherOptions(&parsed.matcher)).add(guidanceOptions(&parsed.guidance));
  po::variables_map values;
  parsed.fault = messageOf([&] {
    parseCommandLine(static_cast<int>(arguments.size()), arguments.data(), {"tool", "", "", ""},
                     options, {}, &values);
  });
  return parsed;
}

TEST(CommandLine, EveryParameterHasAnOptionAndAHelpText) {
  MatcherConfig matcher;
  GuidanceConfig guidance;
  po::options_description options;
  options.add(matcherOptions(&matcher)).add(guidanceOptions(&guidance));
  const auto check = [&](const char* parameter, const auto&) {
    EXPECT_NE(options.find_nothrow(optionName(parameter), false), nullptr) << parameter;
    EXPECT_NE(parameterHelp(parameter), "") << parameter;
  };
  visitMatcherParameters(matcher, check);
  visitGuidanceParameters(guidance, check);
  EXPECT_EQ(optionName("disp12MaxDiff"), "disp12-max-diff");
  EXPECT_EQ(optionName("max_yaw_rate"), "max-yaw-rate");
}

TEST(CommandLine, WithoutOptionsTheDefaultsOfTheStructsHold) {
  const Parsed parsed = parse({});
  EXPECT_EQ(parsed.fault, "");
  EXPECT_EQ(parsed.matcher.disparity_range, MatcherConfig().disparity_range);
  EXPECT_EQ(parsed.matcher.disp12_max_diff, MatcherConfig().disp12_max_diff);
  EXPECT_EQ(parsed.matcher.census_window, MatcherConfig().census_window);
  EXPECT_EQ(parsed.guidance.center_min_fraction, GuidanceConfig().center_min_fraction);
}

TEST(CommandLine, OptionsReachTheirParameters) {
  const Parsed parsed = parse({"--min-disparity", "-16", "--disparity-range=128", "--census-window",
                               "5x5", "--subpixel", "false", "--uniqueness-ratio", "12.5",
                               "--disp12-max-diff", "-1", "--sigma1", "0.25", "--paths-far", "8"});
  EXPECT_EQ(parsed.fault, "");
  EXPECT_EQ(parsed.matcher.min_disparity, -16);
  EXPECT_EQ(parsed.matcher.disparity_range, 128);
  EXPECT_EQ(parsed.matcher.census_window, CensusWindow::k5x5);
  EXPECT_FALSE(parsed.matcher.subpixel);
  EXPECT_DOUBLE_EQ(parsed.matcher.uniqueness_ratio, 12.5);
  EXPECT_EQ(parsed.matcher.disp12_max_diff, -1);
  EXPECT_DOUBLE_EQ(parsed.guidance.sigma1, 0.25);
  EXPECT_EQ(parsed.guidance.paths_far, 8);
  EXPECT_EQ(parse({"--disp12MaxDiff", "3"}).matcher.disp12_max_diff, 3);
}

TEST(CommandLine, MistakesAreExplained) {
  EXPECT_NE(parse({"--disparity-rang", "64"}).fault.find("disparity-rang"), std::string::npos);
  EXPECT_NE(parse({"--disparity-range", "many"}).fault.find("many"), std::string::npos);
  EXPECT_NE(parse({"--census-window", "3x3"}).fault.find("5x5"), std::string::npos);
  EXPECT_NE(parse({"stray"}).fault, "");
}

TEST(CommandLine, ExitCodes) {
  EXPECT_EQ(runTool("t", [] { return 0; }), 0);
  EXPECT_EQ(runTool("t", []() -> int { throw std::runtime_error("x"); }), 1);
  EXPECT_EQ(runTool("t", []() -> int { throw UsageError("x"); }), 2);
  EXPECT_EQ(runTool("t", []() -> int { throw 5; }), 1);
}

TEST(MotionPlan, SidesAndFocus) {
  const GuidanceConfig config;
  const cv::Size size(300, 150);
  const MotionPlan left = planForMotion({config.max_speed, 1.0, 0.0}, config, size);
  EXPECT_EQ(left.plan.paths, (std::array<int, 9>{16, 8, 4, 16, 8, 4, 16, 8, 4}));
  EXPECT_EQ(focusOf(left.plan), cv::Rect(0, 0, 100, 150));
  const MotionPlan up = planForMotion({config.max_speed, 0.0, 0.8}, config, size);
  EXPECT_EQ(focusOf(up.plan), cv::Rect(0, 0, 300, 50));
  const MotionPlan ahead = planForMotion({config.max_speed, 0.0, 0.0}, config, size);
  EXPECT_EQ(focusOf(ahead.plan), cv::Rect(100, 50, 100, 50));
  EXPECT_EQ(focusOf(uniformPlan(300, 150, 8)), cv::Rect(0, 0, 300, 150));
}

TEST(TextTable, AlignsColumns) {
  EXPECT_EQ(textTable({{"a", "value"}, {"long", "1.5"}}),
            "a     value\n----  -----\nlong    1.5\n");
  EXPECT_EQ(fixed(2.0 / 3.0, 2), "0.67");
}

}  // namespace
}  // namespace adaptive_grid_stereo
