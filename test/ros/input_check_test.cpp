// Each refusal names topic, value and cure; hostile fields are refused, odd ones mentioned.

#include "adaptive_grid_stereo/ros/input_check.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "adaptive_grid_stereo/ros/conversions.h"
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

TEST(InputCheck, RefusesImpossibleBaselines) {
  Messages zero;
  zero.right_info.P[3] = 0.0;
  expectRefused(zero.check(), InputFault::kBaseline,
                {"right/camera_info", "0 m", "parameter baseline"});
  Messages endless;
  endless.right_info.P[3] = -1e300;
  expectRefused(endless.check(), InputFault::kBaseline, {"right/camera_info", "millimetres"});
  Messages swapped;
  swapped.right_info.P[3] = 20.0;
  expectRefused(swapped.check(), InputFault::kBaseline, {"-0.2 m", "swapped"});
}

TEST(InputCheck, MentionsABaselineThatMayBeInMillimetres) {
  Messages messages;
  messages.right_info.P[3] = -100.0 * 63.0;
  const InputVerdict verdict = messages.check();
  ASSERT_TRUE(verdict.ok()) << verdict.error;
  ASSERT_EQ(verdict.warnings.size(), 1u);
  const std::string& warning = verdict.warnings[0];
  for (const char* word : {"63 m", "right/camera_info", "millimetres"}) {
    EXPECT_NE(warning.find(word), std::string::npos) << warning;
  }
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

TEST(InputCheck, RefusesStampsFartherApartThanRosDurationsReach) {
  Messages messages;
  messages.left.header.stamp = ros::TIME_MAX;
  EXPECT_EQ(messages.check().warnings.size(), 1U);
  InputLimits limits;
  limits.max_stamp_difference = 0.02;
  expectRefused(messages.check(limits), InputFault::kStampDifference, {"ms"});
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

/// Puts hostile values into a few random fields.
class Vandal {
 public:
  explicit Vandal(std::uint32_t seed) : random_(seed) {}

  int below(int n) { return static_cast<int>(random_() % static_cast<std::uint32_t>(n)); }

  void spoil(sensor_msgs::Image& image) {
    static const char* const kEncodings[] = {"",      "mono8", "mono16", "bgr8",       "rgba8",
                                             "32FC1", "8UC3",  "rgb16",  "bayer_rggb8"};
    switch (below(6)) {
      case 0:
        image.width = size();
        break;
      case 1:
        image.height = size();
        break;
      case 2:
        image.step = size();
        break;
      case 3:
        image.encoding = kEncodings[below(9)];
        break;
      case 4:
        image.data.resize(static_cast<std::size_t>(below(40000)));
        break;
      default:
        image.is_bigendian = static_cast<std::uint8_t>(random_());
    }
  }

  void spoil(sensor_msgs::CameraInfo& info) {
    switch (below(5)) {
      case 0:
        info.P[below(12)] = value();
        break;
      case 1:
        info.binning_x = size();
        break;
      case 2:
        info.binning_y = size();
        break;
      case 3:
        info.roi.width = size();
        info.roi.height = size();
        info.roi.x_offset = size();
        break;
      default:
        info.width = size();
    }
  }

 private:
  std::uint32_t size() {
    static const std::uint32_t kSizes[] = {
        0,   1,   2,          15,         16,  64,   96,    127,        128,       129,
        256, 384, 0x7FFFFFFF, 0x80000000, 512, 1024, 40000, 0xFFFFFFFF, 0xFFFFFF80};
    return kSizes[below(19)];
  }
  double value() {
    static const double kValues[] = {0.0,   -1.0,         1e-300,   1e300,     100.0,
                                     -20.0, std::nan(""), HUGE_VAL, -HUGE_VAL, 64.0};
    return kValues[below(10)];
  }

  std::mt19937 random_;
};

TEST(InputCheck, SurvivesHostileMessagesAndConvertsWhatItTakes) {
  Vandal vandal(1);
  const Messages good;
  int taken = 0;
  for (int i = 0; i < 30000; ++i) {
    Messages messages = good;
    for (int n = vandal.below(3); n >= 0; --n) {
      switch (vandal.below(4)) {
        case 0:
          vandal.spoil(messages.left);
          break;
        case 1:
          vandal.spoil(messages.right);
          break;
        case 2:
          vandal.spoil(messages.left_info);
          break;
        default:
          vandal.spoil(messages.right_info);
      }
    }
    const InputVerdict verdict = messages.check();
    ASSERT_EQ(verdict.ok(), verdict.error.empty());
    if (!verdict.ok()) continue;
    ++taken;
    ASSERT_GT(verdict.geometry.focal_length, 0.0);
    ASSERT_GT(verdict.geometry.baseline, 0.0);
    ASSERT_TRUE(std::isfinite(verdict.geometry.baseline));
    ASSERT_TRUE(std::isfinite(verdict.geometry.center_offset));
    const GreyPair grey = toGreyPair(messages.left, messages.right);
    ASSERT_EQ(grey.left.size(), grey.right.size());
    ASSERT_EQ(grey.left.cols, static_cast<int>(messages.left.width));
    ASSERT_GE(cv::sum(grey.left)[0], 0.0) << "every pixel can be read";
  }
  EXPECT_GT(taken, 1000) << "some changes are harmless";
}

}  // namespace
}  // namespace adaptive_grid_stereo
