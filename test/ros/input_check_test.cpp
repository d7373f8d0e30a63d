// Each refusal names topic, value and cure; hostile fields are refused, odd ones mentioned.

#include "adaptive_grid_stereo/ros/input_check.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "support/synthetic_pair.h"

namespace adaptive_grid_stereo {
namespace {

/// A good pair whose messages a test may change.
struct Messages {
  explicit Messages(const SyntheticRig& rig = SyntheticRig()) {
    const StereoPair pair = makePair(rig, 4, ros::Time(100));
    left = *pair.left;
    right = *pair.right;
    left_info = *pair.left_info;
    right_info = *pair.right_info;
  }
  InputVerdict check(const InputLimits& limits = InputLimits()) const {
    return checkPair(StereoPair{boost::make_shared<sensor_msgs::Image>(left),
                                boost::make_shared<sensor_msgs::Image>(right),
                                boost::make_shared<sensor_msgs::CameraInfo>(left_info),
                                boost::make_shared<sensor_msgs::CameraInfo>(right_info)},
                     limits);
  }
  sensor_msgs::Image left, right;
  sensor_msgs::CameraInfo left_info, right_info;
};

void expectRefused(const InputVerdict& verdict, InputFault fault,
                   const std::vector<std::string>& words) {
  EXPECT_FALSE(verdict.ok());
  EXPECT_EQ(verdict.fault, fault) << verdict.error;
  for (const std::string& word : words) {
    EXPECT_NE(verdict.error.find(word), std::string::npos) << verdict.error << " lacks " << word;
  }
}

TEST(InputCheck, TakesTheGeometryOfAGoodPair) {
  SyntheticRig rig;
  rig.cx_left = 70.0;
  rig.cx_right = 66.5;
  const InputVerdict verdict = Messages(rig).check();
  ASSERT_TRUE(verdict.ok()) << verdict.error;
  EXPECT_TRUE(verdict.warnings.empty());
  EXPECT_DOUBLE_EQ(verdict.geometry.focal_length, 100.0);
  EXPECT_DOUBLE_EQ(verdict.geometry.baseline, 0.2);
  EXPECT_DOUBLE_EQ(verdict.geometry.center_offset, 3.5);
  EXPECT_EQ(verdict.geometry.baseline_source, "camera_info");
}

TEST(InputCheck, RefusesMissingMessages) {
  EXPECT_EQ(checkPair(StereoPair(), InputLimits()).fault, InputFault::kMissing);
}

TEST(InputCheck, RefusesHostileDimensions) {
  for (const unsigned side : {0U, 1U, 15U, 16385U, 0x7FFFFFFFU, 0x80000000U, 0xFFFFFFFFU}) {
    Messages wide;
    wide.left.width = side;
    expectRefused(wide.check(), InputFault::kDimensions,
                  {"left/image_rect", std::to_string(side), "check"});
    Messages high;
    high.right.height = side;
    expectRefused(high.check(), InputFault::kDimensions,
                  {"right/image_rect", std::to_string(side)});
  }
}

TEST(InputCheck, RefusesDataThatDoNotFitTheDimensions) {
  Messages step;
  step.left.step = 127;
  expectRefused(step.check(), InputFault::kDimensions, {"left/image_rect", "step 127", "128"});
  Messages data;
  data.right.data.resize(100);
  expectRefused(data.check(), InputFault::kDimensions, {"right/image_rect", "100 bytes"});
  Messages empty;
  empty.left.data.clear();
  EXPECT_FALSE(empty.check().ok());
  Messages overflow;
  overflow.left.step = 0xFFFFFFFF;
  EXPECT_FALSE(overflow.check().ok());
}

TEST(InputCheck, RefusesUnknownEncodings) {
  for (const char* encoding : {"", "yuv422", "32FC1", "mono", "BGR8", "8UC2"}) {
    Messages messages;
    messages.right.encoding = encoding;
    expectRefused(messages.check(), InputFault::kEncoding,
                  {"right/image_rect", std::string("\"") + encoding + "\"", "mono8"});
  }
  Messages bayer;
  bayer.left.encoding = "bayer_bggr8";
  expectRefused(bayer.check(), InputFault::kEncoding, {"left/image_rect", "image_proc"});
}

TEST(InputCheck, RefusesImagesOfTwoSizes) {
  Messages messages;
  SyntheticRig smaller;
  smaller.width = 64;
  messages.right = Messages(smaller).right;
  expectRefused(messages.check(), InputFault::kSizeMismatch, {"128x96", "64x96", "resolution"});
}

TEST(InputCheck, RefusesACameraInfoOfAnotherImage) {
  Messages messages;
  messages.right_info.width = 640;
  messages.right_info.height = 480;
  expectRefused(messages.check(), InputFault::kSizeMismatch,
                {"right/camera_info", "640x480", "128x96", "binning"});
}

TEST(InputCheck, FollowsBinningAndRegionOfInterest) {
  Messages messages;
  for (sensor_msgs::CameraInfo* info : {&messages.left_info, &messages.right_info}) {
    info->width = 640;
    info->height = 480;
    info->binning_x = info->binning_y = 2;
    info->roi.x_offset = 20;
    info->roi.y_offset = 10;
    info->roi.width = 256;
    info->roi.height = 192;
  }
  messages.left_info.P[2] = 110.0;
  const InputVerdict verdict = messages.check();
  ASSERT_TRUE(verdict.ok()) << verdict.error;
  EXPECT_DOUBLE_EQ(verdict.geometry.focal_length, 50.0);
  EXPECT_DOUBLE_EQ(verdict.geometry.baseline, 0.2);
  EXPECT_DOUBLE_EQ(verdict.geometry.center_offset, (110.0 - 64.0) / 2.0);
}

TEST(InputCheck, TakesACameraInfoWithoutSize) {
  Messages messages;
  messages.left_info.width = messages.left_info.height = 0;
  EXPECT_TRUE(messages.check().ok());
}

TEST(InputCheck, RefusesAnUncalibratedCamera) {
  Messages messages;
  messages.left_info.P.fill(0.0);
  expectRefused(messages.check(), InputFault::kUncalibrated,
                {"left/camera_info", "P[0] = 0", "calibrate"});
  Messages negative;
  negative.right_info.P[0] = -5.0;
  expectRefused(negative.check(), InputFault::kUncalibrated, {"right/camera_info", "-5"});
}

TEST(InputCheck, RefusesNumbersThatAreNone) {
  for (const double value : {std::nan(""), std::numeric_limits<double>::infinity(), -HUGE_VAL}) {
    for (int i = 0; i < 12; ++i) {
      Messages messages;
      messages.right_info.P[i] = value;
      EXPECT_EQ(messages.check().fault, InputFault::kUncalibrated) << i;
    }
  }
}

TEST(InputCheck, RefusesPrincipalPointsFartherApartThanTheImageIsWide) {
  Messages messages;
  messages.left_info.P[2] = 1e30;
  expectRefused(messages.check(), InputFault::kUncalibrated, {"left/camera_info", "1e+30"});
}

TEST(InputCheck, RefusesTwoFocalLengths) {
  Messages messages;
  messages.right_info.P[0] = 110.0;
  expectRefused(messages.check(), InputFault::kFocalLength, {"100", "110", "calibrate"});
}

TEST(InputCheck, RefusesZeroAndNegativeBaselines) {
  Messages zero;
  zero.right_info.P[3] = 0.0;
  expectRefused(zero.check(), InputFault::kBaseline,
                {"right/camera_info", "0 m", "parameter baseline"});
  Messages swapped;
  swapped.right_info.P[3] = 20.0;
  expectRefused(swapped.check(), InputFault::kBaseline, {"-0.2 m", "swapped"});
}

TEST(InputCheck, LetsTheParameterOverrideTheBaseline) {
  Messages messages;
  messages.right_info.P[3] = 0.0;
  InputLimits limits;
  limits.baseline = 0.5;
  const InputVerdict verdict = messages.check(limits);
  ASSERT_TRUE(verdict.ok()) << verdict.error;
  EXPECT_DOUBLE_EQ(verdict.geometry.baseline, 0.5);
  EXPECT_EQ(verdict.geometry.baseline_source, "parameter");
}

TEST(InputCheck, RefusesStampsTooFarApartWhereThereIsALimit) {
  Messages messages;
  messages.right.header.stamp += ros::Duration(0.03);
  EXPECT_TRUE(messages.check().ok());
  InputLimits limits;
  limits.max_stamp_difference = 0.02;
  expectRefused(messages.check(limits), InputFault::kStampDifference,
                {"30 ms", "20 ms", "approximate_sync_max_interval"});
}

TEST(InputCheck, MentionsOddities) {
  Messages frames;
  frames.right.header.frame_id = "right_optical";
  const InputVerdict verdict = frames.check();
  EXPECT_TRUE(verdict.ok());
  ASSERT_EQ(verdict.warnings.size(), 1U);
  EXPECT_NE(verdict.warnings[0].find("right_optical"), std::string::npos);

  Messages late;
  late.right.header.stamp += ros::Duration(0.01);
  EXPECT_EQ(late.check().warnings.size(), 1U);

  Messages bare;
  bare.left.header = bare.right.header = std_msgs::Header();
  EXPECT_EQ(bare.check().warnings.size(), 2U) << "no frame, no stamp";
}

}  // namespace
}  // namespace adaptive_grid_stereo
