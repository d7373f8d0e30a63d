// Every conversion between messages and the matcher, field by field.

#include "adaptive_grid_stereo/ros/conversions.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <boost/make_shared.hpp>

#include "support/synthetic_pair.h"

namespace adaptive_grid_stereo {
namespace {

MatchResult makeResult(int width, int height, std::int16_t value, int min_disparity = 0,
                       int disparity_range = 64) {
  MatchResult result;
  result.disparity = cv::Mat(height, width, CV_16SC1, cv::Scalar(value));
  result.min_disparity = min_disparity;
  result.disparity_range = disparity_range;
  return result;
}

StereoGeometry makeGeometry(double center_offset = 0.0) {
  StereoGeometry geometry;
  geometry.focal_length = 400.0;
  geometry.baseline = 0.25;
  geometry.center_offset = center_offset;
  geometry.baseline_source = "camera_info";
  return geometry;
}

std_msgs::Header makeHeader() {
  std_msgs::Header header;
  header.frame_id = "left_optical";
  header.stamp = ros::Time(12, 34);
  return header;
}

stereo_msgs::DisparityImagePtr toDisparityImage(const MatchResult& result,
                                                const StereoGeometry& geometry,
                                                const std_msgs::Header& header) {
  auto message = boost::make_shared<stereo_msgs::DisparityImage>();
  fillDisparityImage(result, geometry, header, message.get());
  return message;
}

float at(const sensor_msgs::Image& image, unsigned x, unsigned y) {
  float value = 0.0F;
  std::memcpy(&value, &image.data[y * image.step + x * sizeof(float)], sizeof(value));
  return value;
}

TEST(DisparityImage, LeavesNothingOfAnOlderOneInItsMessage) {
  MatchResult older = makeResult(100, 40, 5 * kDisparityScale, 2, 48);
  std_msgs::Header header = makeHeader();
  header.frame_id = "older";
  const auto message = toDisparityImage(older, makeGeometry(4.5), header);
  const MatchResult result = makeResult(60, 50, 7 * kDisparityScale);
  fillDisparityImage(result, makeGeometry(), makeHeader(), message.get());
  const auto fresh = toDisparityImage(result, makeGeometry(), makeHeader());
  const auto bytes = [](const stereo_msgs::DisparityImage& of) {
    std::vector<std::uint8_t> written(ros::serialization::serializationLength(of));
    ros::serialization::OStream stream(written.data(), static_cast<std::uint32_t>(written.size()));
    ros::serialization::serialize(stream, of);
    return written;
  };
  EXPECT_EQ(bytes(*fresh), bytes(*message));
}

TEST(DisparityImage, HoldsEveryFieldOfTheSpecification) {
  MatchResult result = makeResult(100, 40, 5 * kDisparityScale + 3, 2, 48);
  result.disparity.at<std::int16_t>(7, 9) = kInvalidDisparity;
  const auto message = toDisparityImage(result, makeGeometry(), makeHeader());

  EXPECT_EQ(message->header.frame_id, "left_optical");
  EXPECT_EQ(message->header.stamp, ros::Time(12, 34));
  EXPECT_EQ(message->image.header.frame_id, "left_optical");
  EXPECT_EQ(message->image.header.stamp, ros::Time(12, 34));
  EXPECT_EQ(message->image.encoding, "32FC1");
  EXPECT_EQ(message->image.width, 100U);
  EXPECT_EQ(message->image.height, 40U);
  EXPECT_EQ(message->image.step, 400U);
  EXPECT_EQ(message->image.data.size(), 16000U);
  EXPECT_EQ(message->image.is_bigendian, 0);
  EXPECT_FLOAT_EQ(message->f, 400.0F);
  EXPECT_FLOAT_EQ(message->T, 0.25F);
  EXPECT_FLOAT_EQ(message->min_disparity, 2.0F);
  EXPECT_FLOAT_EQ(message->max_disparity, 49.0F);
  EXPECT_FLOAT_EQ(message->delta_d, 1.0F / 16.0F);
  EXPECT_FLOAT_EQ(at(message->image, 0, 0), 2.0F + 5.0F + 3.0F / 16.0F);
  EXPECT_FLOAT_EQ(at(message->image, 9, 7), 1.0F) << "invalid is min_disparity - 1";
}

TEST(DisparityImage, TakesTheDifferenceOfThePrincipalPointsOffOnce) {
  MatchResult result = makeResult(20, 20, 30 * kDisparityScale);
  result.disparity.at<std::int16_t>(0, 0) = kInvalidDisparity;
  const auto message = toDisparityImage(result, makeGeometry(4.5), makeHeader());
  EXPECT_FLOAT_EQ(at(message->image, 5, 5), 25.5F);
  EXPECT_FLOAT_EQ(message->min_disparity, -4.5F);
  EXPECT_FLOAT_EQ(message->max_disparity, 58.5F);
  EXPECT_FLOAT_EQ(at(message->image, 0, 0), -5.5F);
}

TEST(DisparityImage, OfAnImageWithoutInvalidPixelMarksOne) {
  const auto message = toDisparityImage(makeResult(20, 20, 80), makeGeometry(), makeHeader());
  EXPECT_FLOAT_EQ(at(message->image, 0, 0), -1.0F);
  EXPECT_FLOAT_EQ(at(message->image, 1, 0), 5.0F);
}

TEST(DisparityImage, KeepsRowsApartWhereTheResultIsAView) {
  MatchResult result = makeResult(40, 20, 16);
  result.disparity.colRange(20, 40).setTo(32);
  result.disparity = result.disparity.colRange(15, 25);
  const auto message = toDisparityImage(result, makeGeometry(), makeHeader());
  EXPECT_FLOAT_EQ(at(message->image, 4, 19), 1.0F);
  EXPECT_FLOAT_EQ(at(message->image, 5, 19), 2.0F);
}

TEST(ValidWindow, IsWhereACandidateLiesInsideTheRightImage) {
  struct Case {
    int min_disparity, range;
    unsigned x, width;
  };
  for (const Case& c :
       {Case{0, 64, 0, 100}, Case{10, 16, 10, 90}, Case{-16, 16, 0, 99}, Case{-32, 16, 0, 83},
        Case{-8, 32, 0, 100}, Case{100, 16, 100, 0}, Case{-500, 16, 0, 0}, Case{500, 16, 100, 0}}) {
    const auto window = validWindow(100, 40, c.min_disparity, c.range);
    EXPECT_EQ(window.x_offset, c.x) << c.min_disparity;
    EXPECT_EQ(window.width, c.width) << c.min_disparity;
    EXPECT_EQ(window.y_offset, 0U);
    EXPECT_EQ(window.height, c.width > 0 ? 40U : 0U);
    EXPECT_LE(window.x_offset + window.width, 100U);
    EXPECT_FALSE(window.do_rectify);
  }
}

TEST(DepthImage, FollowsRep118) {
  MatchResult result = makeResult(20, 20, 10 * kDisparityScale);
  result.disparity.at<std::int16_t>(1, 1) = kInvalidDisparity;
  result.disparity.at<std::int16_t>(2, 2) = 4 * kDisparityScale;
  result.disparity.at<std::int16_t>(3, 3) = 2 * kDisparityScale;
  const auto depth = toDepthImage(*toDisparityImage(result, makeGeometry(4.0), makeHeader()));
  EXPECT_EQ(depth->encoding, "32FC1");
  EXPECT_EQ(depth->header.frame_id, "left_optical");
  EXPECT_EQ(depth->step, 80U);
  EXPECT_FLOAT_EQ(at(*depth, 0, 0), 400.0F * 0.25F / 6.0F) << "f * T / (10 - 4)";
  EXPECT_TRUE(std::isnan(at(*depth, 1, 1)));
  EXPECT_EQ(at(*depth, 2, 2), std::numeric_limits<float>::infinity()) << "at infinity";
  EXPECT_EQ(at(*depth, 3, 3), std::numeric_limits<float>::infinity()) << "beyond infinity";
}

TEST(ColorImage, IsBlackWhereInvalidAndRedWhereNear) {
  MatchResult result = makeResult(20, 20, 60 * kDisparityScale);
  result.disparity.at<std::int16_t>(1, 1) = kInvalidDisparity;
  result.disparity.at<std::int16_t>(2, 2) = 4 * kDisparityScale;
  const auto color = toColorImage(*toDisparityImage(result, makeGeometry(), makeHeader()));
  EXPECT_EQ(color->encoding, "bgr8");
  EXPECT_EQ(color->step, 60U);
  const auto pixel = [&](int x, int y) { return &color->data[y * color->step + 3 * x]; };
  EXPECT_EQ(pixel(1, 1)[0] + pixel(1, 1)[1] + pixel(1, 1)[2], 0);
  EXPECT_GT(pixel(0, 0)[2], pixel(0, 0)[0]) << "near: more red than blue";
  EXPECT_GT(pixel(2, 2)[0], pixel(2, 2)[2]) << "far: more blue than red";
}

TEST(Grey, ViewsMono8InPlace) {
  const StereoPair pair = makePair(SyntheticRig(), 4, ros::Time(1));
  const GreyPair grey = toGreyPair(*pair.left, *pair.right);
  EXPECT_EQ(grey.left.data, pair.left->data.data());
  EXPECT_EQ(grey.right.data, pair.right->data.data());
  EXPECT_EQ(grey.left.type(), CV_8UC1);
}

TEST(Grey, ViewsRowsWithPadding) {
  sensor_msgs::Image image;
  image.width = 16;
  image.height = 2;
  image.step = 20;
  image.encoding = "8UC1";
  image.data.assign(40, 0);
  image.data[20] = 77;
  const GreyPair grey = toGreyPair(image, image);
  EXPECT_EQ(grey.left.at<std::uint8_t>(1, 0), 77);
}

TEST(Grey, WeighsColoursInEveryOrder) {
  const cv::Vec3b orange(20, 120, 240);  // blue, green, red
  cv::Mat bgr(16, 16, CV_8UC3, cv::Scalar(orange));
  cv::Mat expected;
  cv::cvtColor(bgr, expected, cv::COLOR_BGR2GRAY);
  cv::Mat rgb, bgra, rgba;
  cv::cvtColor(bgr, rgb, cv::COLOR_BGR2RGB);
  cv::cvtColor(bgr, bgra, cv::COLOR_BGR2BGRA);
  cv::cvtColor(bgr, rgba, cv::COLOR_BGR2RGBA);
  const struct {
    const char* encoding;
    cv::Mat image;
  } cases[] = {{"bgr8", bgr}, {"8UC3", bgr}, {"rgb8", rgb}, {"bgra8", bgra}, {"rgba8", rgba}};
  for (const auto& c : cases) {
    const auto message = toMessage(c.image, c.encoding, makeHeader());
    const GreyPair grey = toGreyPair(*message, *message);
    EXPECT_EQ(cv::norm(grey.left, expected, cv::NORM_INF), 0.0) << c.encoding;
  }
}

sensor_msgs::ImagePtr mono16(std::uint16_t value) {
  return toMessage(cv::Mat(16, 16, CV_16UC1, cv::Scalar(value)), "mono16", makeHeader());
}

TEST(Grey, KeepsTheHighBitsOfA12BitCamera) {
  // 3000 needs 12 bits: shifted by 4 on both sides, though the right image alone would need 10
  // bits.
  const GreyPair grey = toGreyPair(*mono16(3000), *mono16(1000));
  EXPECT_EQ(grey.left.at<std::uint8_t>(3, 3), 3000 >> 4);
  EXPECT_EQ(grey.right.at<std::uint8_t>(3, 3), 1000 >> 4);
}

TEST(Grey, CountsTheBitsOfThePair) {
  const struct {
    std::uint16_t value;
    int shift;
  } cases[] = {{255, 0}, {256, 2}, {1023, 2}, {1024, 4}, {4096, 6}, {16384, 8}, {65535, 8}};
  for (const auto& c : cases) {
    const GreyPair grey = toGreyPair(*mono16(c.value), *mono16(c.value));
    EXPECT_EQ(grey.left.at<std::uint8_t>(0, 0), c.value >> c.shift) << c.value;
  }
}

TEST(Grey, TakesStatedBitsAndSaturatesBeyond) {
  const GreyPair grey = toGreyPair(*mono16(3000), *mono16(5000), 12);
  EXPECT_EQ(grey.left.at<std::uint8_t>(0, 0), 3000 >> 4);
  EXPECT_EQ(grey.right.at<std::uint8_t>(0, 0), 255);
}

TEST(Grey, ReadsBigEndianImages) {
  auto message = mono16(0x0BB8);
  for (std::size_t i = 0; i < message->data.size(); i += 2) {
    std::swap(message->data[i], message->data[i + 1]);
  }
  message->is_bigendian = 1;
  const GreyPair grey = toGreyPair(*message, *message, 12);
  EXPECT_EQ(grey.left.at<std::uint8_t>(5, 5), 0x0BB8 >> 4);
}

TEST(ImageFault, NamesWhatIsWrongWithHostileFields) {
  const StereoPair pair = makePair(SyntheticRig(), 4, ros::Time(1));
  const auto faultOf = [&](auto change) {
    sensor_msgs::Image image = *pair.left;
    change(image);
    return imageFault(image);
  };
  using Image = sensor_msgs::Image;
  EXPECT_EQ(faultOf([](Image&) {}), "");
  EXPECT_NE(faultOf([](Image& i) { i.width = 0; }), "");
  EXPECT_NE(faultOf([](Image& i) { i.height = 0xFFFFFFFF; }), "");
  EXPECT_NE(faultOf([](Image& i) { i.width = 0x80000000; }), "");
  EXPECT_NE(faultOf([](Image& i) { i.step = 100; }).find("step 100"), std::string::npos);
  EXPECT_NE(faultOf([](Image& i) { i.data.pop_back(); }).find("bytes of data"), std::string::npos);
  EXPECT_NE(faultOf([](Image& i) { i.step = 0xFFFFFFFF; }), "") << "step * height overflows";
  EXPECT_NE(faultOf([](Image& i) { i.encoding = ""; }), "");
  EXPECT_NE(faultOf([](Image& i) { i.encoding = "bayer_rggb8"; }).find("image_proc"),
            std::string::npos);
  EXPECT_NE(faultOf([](Image& i) { i.encoding = "mono16"; }), "") << "too few bytes for 16 bits";
}

TEST(ImageFault, IsThrownByTheConversion) {
  const StereoPair pair = makePair(SyntheticRig(), 4, ros::Time(1));
  sensor_msgs::Image broken = *pair.left;
  broken.data.clear();
  EXPECT_THROW(toGreyPair(broken, *pair.right), std::invalid_argument);
}

TEST(CellStatistics, CountPixelsAndFindTheNearestSurface) {
  MatchResult result = makeResult(90, 60, 10 * kDisparityScale);
  result.disparity(cv::Rect(0, 0, 30, 20)).setTo(kInvalidDisparity);
  result.disparity(cv::Rect(30, 0, 15, 20)).setTo(kInvalidDisparity);
  result.disparity(cv::Rect(31, 21, 5, 5)).setTo(40 * kDisparityScale);
  result.disparity.at<std::int16_t>(50, 50) = 63 * kDisparityScale;
  PathPlan plan = uniformPlan(90, 60, 8);
  plan.column_edges = {0, 30, 60, 90};
  plan.row_edges = {0, 20, 40, 60};
  const CellStatistics cells = cellStatistics(result, makeGeometry(), plan);
  EXPECT_FLOAT_EQ(cells.density[0], 0.0F);
  EXPECT_TRUE(std::isnan(cells.nearest_range[0]));
  EXPECT_FLOAT_EQ(cells.density[1], 0.5F);
  EXPECT_FLOAT_EQ(cells.nearest_range[1], 10.0F) << "400 * 0.25 / 10";
  EXPECT_FLOAT_EQ(cells.nearest_range[4], 2.5F) << "25 pixels are a thing";
  EXPECT_FLOAT_EQ(cells.nearest_range[7], 10.0F) << "one pixel is not";
}

TEST(CellStatistics, EqualThoseOfSortedPixels) {
  cv::RNG random(3);
  for (int round = 0; round < 60; ++round) {
    const int width = random.uniform(3, 150), height = random.uniform(3, 80);
    MatchResult result = makeResult(width, height, 0);
    // Ground that comes nearer downwards or upwards, or not at all, more or less of it invalid.
    const int slope = random.uniform(-8, 9), noise = random.uniform(1, 200);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const int value = 400 + slope * (y - height / 2) + random.uniform(-noise, noise + 1);
        const bool invalid = random.uniform(0, 10) < round % 11;
        result.disparity.at<std::int16_t>(y, x) =
            static_cast<std::int16_t>(invalid ? kInvalidDisparity : std::clamp(value, 0, 1023));
      }
    }
    const CellStatistics cells =
        cellStatistics(result, makeGeometry(), uniformPlan(width, height, 16));
    std::vector<int> valid;
    for (const std::int16_t value : cv::Mat_<std::int16_t>(result.disparity)) {
      if (value != kInvalidDisparity) valid.push_back(value);
    }
    std::sort(valid.rbegin(), valid.rend());
    const double pixels = static_cast<double>(width) * height;
    EXPECT_FLOAT_EQ(cells.density[4], static_cast<float>(valid.size() / pixels));
    const std::size_t enough = std::max<long>(kNearestPixels, std::lround(kNearestShare * pixels));
    if (valid.size() < enough) {
      EXPECT_TRUE(std::isnan(cells.nearest_range[4]));
    } else {
      EXPECT_FLOAT_EQ(cells.nearest_range[4],
                      static_cast<float>(400.0 * 0.25 * kDisparityScale / valid[enough - 1]));
    }
  }
}

TEST(CellStatistics, AreNanInEmptyCellsAndInfiniteAtInfinity) {
  const CellStatistics cells =
      cellStatistics(makeResult(60, 40, 0), makeGeometry(), uniformPlan(60, 40, 16));
  EXPECT_TRUE(std::isnan(cells.density[0]));
  EXPECT_TRUE(std::isnan(cells.nearest_range[0]));
  EXPECT_FLOAT_EQ(cells.density[4], 1.0F);
  EXPECT_EQ(cells.nearest_range[4], std::numeric_limits<float>::infinity());
}

TEST(GridStateMessage, HoldsMotionStateAndPlan) {
  Motion motion;
  motion.valid = true;
  motion.forward_speed = 10.0;
  motion.yaw_rate = -0.5;
  motion.pitch_rate = 0.2;
  motion.speed_source = "odom";
  motion.rate_source = "imu";
  FlightState state;
  state.motion_known = state.forward = true;
  state.yaw = YawSide::kRight;
  const GuidanceConfig config;
  PathPlan plan = uniformPlan(60, 40, 16);
  plan.paths = {4, 8, 16, 4, 8, 16, 4, 8, 16};
  const auto message =
      toGridState(makeHeader(), motion, state, plan,
                  cellStatistics(makeResult(60, 40, 16), makeGeometry(), plan), config);
  EXPECT_EQ(message->header.frame_id, "left_optical");
  EXPECT_EQ(message->state, GridState::FORWARD | GridState::YAW);
  EXPECT_TRUE(message->motion_valid);
  EXPECT_EQ(message->speed_source, "odom");
  EXPECT_EQ(message->rate_source, "imu");
  EXPECT_DOUBLE_EQ(message->forward_speed, 10.0);
  EXPECT_DOUBLE_EQ(message->yaw_rate, -0.5);
  EXPECT_DOUBLE_EQ(message->pitch_rate, 0.2);
  EXPECT_DOUBLE_EQ(message->speed_ratio, 0.5);
  EXPECT_DOUBLE_EQ(message->yaw_ratio, 0.5);
  EXPECT_DOUBLE_EQ(message->pitch_ratio, 0.25);
  EXPECT_EQ(message->paths[2], 16);
  EXPECT_EQ(message->paths[3], 4);
  EXPECT_EQ(message->column_edges[2], 60);
  EXPECT_EQ(message->row_edges[3], 40);
}

TEST(GridStateMessage, HasNoStateWhileTheMotionIsUnknown) {
  FlightState state;
  state.locked = true;
  EXPECT_EQ(toStateBits(state), 0);
  state.motion_known = true;
  EXPECT_EQ(toStateBits(state), GridState::LOCKED);
  state.locked = false;
  state.forward = true;
  state.pitch = PitchSide::kDown;
  EXPECT_EQ(toStateBits(state), GridState::FORWARD | GridState::PITCH);
}

}  // namespace
}  // namespace adaptive_grid_stereo
