#include "adaptive_grid_stereo/guidance/guidance_config.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "adaptive_grid_stereo/guidance/motion_config.h"

namespace adaptive_grid_stereo {
namespace {

TEST(GuidanceConfigTest, DefaultsAreLegal) {
  EXPECT_TRUE(GuidanceConfig().validate().empty());
  EXPECT_TRUE(MotionConfig().validate().empty());
}

TEST(GuidanceConfigTest, CorrectsWithASentenceEach) {
  GuidanceConfig config;
  config.lock_speed = -1.0;
  config.max_speed = 0.0;
  config.max_yaw_rate = std::nan("");
  config.sigma1 = 1.5;
  config.sigma2 = -std::numeric_limits<double>::infinity();
  config.hysteresis = 2.0;
  const auto sentences = config.validate();
  ASSERT_EQ(sentences.size(), 6u);
  EXPECT_NE(sentences[0].find("lock_speed: -1 -> 0"), std::string::npos) << sentences[0];
  EXPECT_EQ(config.lock_speed, 0.0);
  EXPECT_EQ(config.max_speed, 0.1);
  EXPECT_EQ(config.max_yaw_rate, GuidanceConfig().max_yaw_rate);
  EXPECT_EQ(config.sigma1, 1.0);
  EXPECT_EQ(config.sigma2, 0.0);
  EXPECT_EQ(config.hysteresis, 1.0);
  EXPECT_TRUE(config.validate().empty()) << "a second time there is nothing left to change";
}

TEST(GuidanceConfigTest, LadderIsLegalAndNeverIncreases) {
  for (int focus = -1; focus <= 33; ++focus) {
    for (int near = -1; near <= 33; near += 2) {
      for (int far = -1; far <= 33; far += 3) {
        GuidanceConfig config;
        config.paths_focus = focus;
        config.paths_near = near;
        config.paths_far = far;
        config.validate();
        for (const int paths : {config.paths_focus, config.paths_near, config.paths_far}) {
          EXPECT_TRUE(paths == 4 || paths == 8 || paths == 16) << paths;
        }
        EXPECT_GE(config.paths_focus, config.paths_near);
        EXPECT_GE(config.paths_near, config.paths_far);
      }
    }
  }
}

TEST(MotionConfigTest, CorrectsWithASentenceEach) {
  MotionConfig config;
  config.speed_source = "gps";
  config.rate_source = "gyro";
  config.gps_velocity_axes = "east";
  config.motion_timeout = 0.0;
  config.rate_filter_time = -0.1;
  config.camera_rpy = {{0.0, std::nan(""), 0.0}};
  const auto sentences = config.validate();
  ASSERT_EQ(sentences.size(), 6u);
  EXPECT_NE(sentences[0].find("odom, gps_vel, gps_fix"), std::string::npos) << sentences[0];
  EXPECT_EQ(config.speed_source, "auto");
  EXPECT_EQ(config.rate_source, "auto");
  EXPECT_EQ(config.gps_velocity_axes, "auto");
  EXPECT_EQ(config.motion_timeout, 0.01);
  EXPECT_EQ(config.rate_filter_time, 0.0);
  EXPECT_EQ(config.camera_rpy[1], 0.0);
}

TEST(MotionConfigTest, NamesOfAxesGoBothWays) {
  for (const char* name : {"body_flu", "body_frd", "enu", "ned"}) {
    EXPECT_STREQ(toString(velocityAxesFromString(name)), name);
  }
  for (const char* name : {"body_flu", "body_frd"}) {
    EXPECT_STREQ(toString(rateAxesFromString(name)), name);
  }
  EXPECT_THROW(velocityAxesFromString("ENU"), std::invalid_argument);
  EXPECT_THROW(rateAxesFromString("ned"), std::invalid_argument);
}

}  // namespace
}  // namespace adaptive_grid_stereo
