#include "adaptive_grid_stereo/matching/matcher_config.h"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

namespace adaptive_grid_stereo {
namespace {

TEST(MatcherConfig, defaultsAreLegal) { EXPECT_TRUE(MatcherConfig().validate().empty()); }

TEST(MatcherConfig, roundsTheDisparityRangeUpAndSaysSo) {
  MatcherConfig config;
  config.disparity_range = 65;
  const std::vector<std::string> sentences = config.validate();
  EXPECT_EQ(80, config.disparity_range);
  ASSERT_EQ(1u, sentences.size());
  EXPECT_EQ("disparity_range: 65 -> 80 (a multiple of 16)", sentences[0]);
}

TEST(MatcherConfig, limitsEveryValue) {
  MatcherConfig low, high;
  low.min_disparity = low.disparity_range = low.penalty_small = low.penalty_large = -5000;
  low.penalty_large_min = low.disp12_max_diff = low.speckle_size = low.speckle_range = -5000;
  low.threads = -1;
  low.uniqueness_ratio = std::nan("");
  high.min_disparity = high.disparity_range = high.penalty_small = high.penalty_large = 1 << 30;
  high.penalty_large_min = high.disp12_max_diff = high.speckle_size = 1 << 30;
  high.speckle_range = high.threads = 1 << 30;
  high.uniqueness_ratio = INFINITY;
  for (MatcherConfig* config : {&low, &high}) {
    EXPECT_GE(config->validate().size(), 10u);
    EXPECT_TRUE(config->validate().empty()) << "a second pass has nothing left to correct";
    EXPECT_GT(config->penalty_large_min, config->penalty_small);
    EXPECT_LE(static_cast<int>(config->census_window) + kLargestPenalty, 255);
  }
}

TEST(MatcherConfig, keepsThePenaltiesInOrder) {
  MatcherConfig config;
  config.penalty_small = 50;
  config.penalty_large_min = 50;
  EXPECT_EQ(1u, config.validate().size());
  EXPECT_EQ(51, config.penalty_large_min);
}

TEST(CensusWindow, hasNames) {
  for (const CensusWindow window : {CensusWindow::k5x5, CensusWindow::k7x7, CensusWindow::k9x7}) {
    EXPECT_EQ(window, censusWindowFromString(toString(window)));
  }
  EXPECT_THROW(censusWindowFromString("6x6"), std::invalid_argument);
}

}  // namespace
}  // namespace adaptive_grid_stereo
