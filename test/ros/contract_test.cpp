// What the running nodelet promises: topics, lazy subscription, every output, reconfiguration while
// frames arrive, and for each kind of bad input its sentence and the next good frame.

#include <cmath>
#include <limits>

#include <diagnostic_msgs/DiagnosticArray.h>
#include <gtest/gtest.h>

#include "adaptive_grid_stereo/GridState.h"
#include "support/node_probe.h"

namespace adaptive_grid_stereo {
namespace {

using stereo_msgs::DisparityImage;

class Contract : public testing::Test {
 protected:
  Contract() : aircraft_(handle_, "/stereo"), spinner_(4) { spinner_.start(); }

  /// Publishes a good pair and waits for its disparity, which is checked.
  Listener<DisparityImage>::ConstPtr expectServed(Listener<DisparityImage>& disparity, int shift) {
    const ros::Time stamp = stamps().next();
    aircraft_.publish(makePair(SyntheticRig(), shift, stamp));
    const auto message = disparity.waitForStamp(stamp);
    EXPECT_TRUE(message) << "no disparity for a good pair";
    if (message) {
      EXPECT_GT(shareAt(*message, shift, shift), 0.9);
    }
    return message;
  }

  /// Publishes motion and a pair until the node's answer has motion_valid as expected: images and
  /// motion come by different connections, so that a pair may overtake its motion. Each attempt
  /// gives the motion more of a start.
  GridStateConstPtr fly(Listener<GridState>& grid_state, double speed, double yaw_rate,
                        bool expected_valid) {
    GridStateConstPtr message;
    for (int attempt = 0; attempt < 20; ++attempt) {
      // Far apart, so that each starts from samples of its own.
      ros::Time stamp;
      for (int i = 0; i < 30; ++i) stamp = stamps().next();
      aircraft_.publishMotion(stamp, speed, yaw_rate);
      ros::WallDuration(0.01 * attempt).sleep();
      aircraft_.publish(makePair(SyntheticRig(), 5, stamp));
      message = grid_state.waitForStamp(stamp);
      if (!message || static_cast<bool>(message->motion_valid) == expected_valid) break;
    }
    return message;
  }

  /// One clock for all tests, since they share the node.
  static StampSource& stamps() {
    static StampSource source;
    return source;
  }

  ros::NodeHandle handle_;
  FakeAircraft aircraft_;
  ros::AsyncSpinner spinner_;
};

TEST_F(Contract, SubscribesOnlyWhileSomebodyListens) {
  ASSERT_TRUE(aircraft_.waitIdle());
  {
    Listener<DisparityImage> disparity(handle_, "/stereo/disparity");
    EXPECT_TRUE(aircraft_.waitSubscribed());
  }
  EXPECT_TRUE(aircraft_.waitIdle());
  {
    Listener<GridState> grid_state(handle_, "/stereo/grid_state");
    EXPECT_TRUE(aircraft_.waitSubscribed());
  }
  EXPECT_TRUE(aircraft_.waitIdle());
  for (const char* topic : {"depth", "grid_overlay", "disparity_color"}) {
    {
      Listener<sensor_msgs::Image> image(handle_, std::string("/stereo/") + topic);
      EXPECT_TRUE(aircraft_.waitSubscribed()) << topic;
    }
    EXPECT_TRUE(aircraft_.waitIdle()) << topic;
  }
}

TEST_F(Contract, FillsTheDisparityImage) {
  Listener<DisparityImage> disparity(handle_, "/stereo/disparity");
  ASSERT_TRUE(aircraft_.waitSubscribed());
  const auto message = expectServed(disparity, 6);
  ASSERT_TRUE(message);
  EXPECT_EQ(message->header.frame_id, "left_optical");
  EXPECT_EQ(message->image.encoding, "32FC1");
  EXPECT_EQ(message->image.width, 128U);
  EXPECT_EQ(message->image.height, 96U);
  EXPECT_FLOAT_EQ(message->f, 100.0F);
  EXPECT_FLOAT_EQ(message->T, 0.2F);
  EXPECT_FLOAT_EQ(message->min_disparity, 0.0F);
  EXPECT_FLOAT_EQ(message->max_disparity, 31.0F);
  EXPECT_FLOAT_EQ(message->delta_d, 0.0625F);
  EXPECT_EQ(message->valid_window.x_offset, 0U);
  EXPECT_EQ(message->valid_window.width, 128U);
  EXPECT_EQ(message->valid_window.height, 96U);
  float smallest = 1e9F;
  for (unsigned y = 0; y < 96; ++y) {
    const auto* row = reinterpret_cast<const float*>(&message->image.data[y * message->image.step]);
    for (unsigned x = 0; x < 128; ++x) {
      ASSERT_FALSE(std::isnan(row[x]));
      EXPECT_TRUE(row[x] == -1.0F || (row[x] >= 0.0F && row[x] <= 31.0F)) << row[x];
      smallest = std::min(smallest, row[x]);
    }
  }
  EXPECT_EQ(smallest, -1.0F) << "point_cloud2 takes the smallest value for invalid";
}

TEST_F(Contract, FollowsTheMotion) {
  Listener<GridState> grid_state(handle_, "/stereo/grid_state");
  ASSERT_TRUE(aircraft_.waitSubscribed());
  ASSERT_TRUE(waitUntil([&] {
    return aircraft_.odom.getNumSubscribers() > 0 && aircraft_.imu.getNumSubscribers() > 0;
  }));
  const struct {
    double speed, yaw_rate;
    int state, left, centre, right;
  } cases[] = {{20.0, 0.0, GridState::FORWARD, 8, 16, 8},
               {20.0, 0.6, GridState::FORWARD | GridState::YAW, 16, 8, 4},
               {20.0, -0.6, GridState::FORWARD | GridState::YAW, 4, 8, 16},
               {0.0, 0.0, GridState::LOCKED, 16, 16, 16}};
  for (const auto& c : cases) {
    const auto message = fly(grid_state, c.speed, c.yaw_rate, true);
    ASSERT_TRUE(message);
    EXPECT_TRUE(message->motion_valid) << message->motion_status;
    EXPECT_EQ(message->state, c.state) << c.speed << " " << c.yaw_rate;
    EXPECT_NEAR(message->forward_speed, c.speed, 0.01);
    EXPECT_NEAR(message->yaw_rate, c.yaw_rate, 0.01);
    EXPECT_EQ(message->paths[3], c.left);
    EXPECT_EQ(message->paths[4], c.centre);
    EXPECT_EQ(message->paths[5], c.right);
    EXPECT_GT(message->density[4], 0.9F);
    EXPECT_GT(message->processing_time, 0.0);
  }
}

TEST_F(Contract, SurvivesMotionThatIsNoNumber) {
  Listener<GridState> grid_state(handle_, "/stereo/grid_state");
  ASSERT_TRUE(aircraft_.waitSubscribed());
  ASSERT_TRUE(waitUntil([&] { return aircraft_.odom.getNumSubscribers() > 0; }));
  const auto blind = fly(grid_state, std::nan(""), std::numeric_limits<double>::infinity(), false);
  ASSERT_TRUE(blind);
  EXPECT_FALSE(blind->motion_valid);
  EXPECT_FALSE(blind->motion_status.empty());
  EXPECT_EQ(blind->state, 0);
  for (const int paths : blind->paths) EXPECT_EQ(paths, 8) << "uniform plan";
  const auto seeing = fly(grid_state, 15.0, 0.0, true);
  ASSERT_TRUE(seeing);
  EXPECT_TRUE(seeing->motion_valid) << seeing->motion_status;
}

TEST_F(Contract, MakesTheSideOutputs) {
  Listener<sensor_msgs::Image> depth(handle_, "/stereo/depth");
  Listener<sensor_msgs::Image> overlay(handle_, "/stereo/grid_overlay");
  Listener<sensor_msgs::Image> color(handle_, "/stereo/disparity_color");
  ASSERT_TRUE(aircraft_.waitSubscribed());
  ASSERT_TRUE(depth.waitConnected() && overlay.waitConnected() && color.waitConnected());
  const ros::Time stamp = stamps().next();
  aircraft_.publish(makePair(SyntheticRig(), 8, stamp));
  const auto depth_image = depth.waitForStamp(stamp);
  const auto overlay_image = overlay.waitForStamp(stamp);
  const auto color_image = color.waitForStamp(stamp);
  ASSERT_TRUE(depth_image && overlay_image && color_image);
  EXPECT_EQ(depth_image->encoding, "32FC1");
  float metres = 0.0F;
  std::memcpy(&metres, &depth_image->data[48 * depth_image->step + 80 * 4], 4);
  EXPECT_NEAR(metres, 100.0 * 0.2 / 8.0, 0.1);
  EXPECT_EQ(overlay_image->encoding, "bgr8");
  EXPECT_EQ(overlay_image->width, 640U) << "enlarged to be legible";
  EXPECT_EQ(color_image->encoding, "bgr8");
  EXPECT_EQ(color_image->width, 128U);
}

TEST_F(Contract, ReconfiguresWhileFramesArriveAndLosesNone) {
  Listener<DisparityImage> disparity(handle_, "/stereo/disparity");
  Listener<GridState> grid_state(handle_, "/stereo/grid_state");
  ASSERT_TRUE(aircraft_.waitSubscribed());
  ASSERT_TRUE(disparity.waitConnected() && grid_state.waitConnected());
  std::vector<ros::Time> published;
  dynamic_reconfigure::Config response;
  for (const int range : {48, 64, 16, 32}) {
    for (int i = 0; i < 3; ++i) {
      published.push_back(stamps().next());
      aircraft_.publish(makePair(SyntheticRig(), 6, published.back()));
    }
    dynamic_reconfigure::Config config;
    addInt(config, "disparity_range", range);
    ASSERT_TRUE(reconfigure("/stereo/disparity", config, &response));
    // The service has answered, so the next frame has the new range.
    published.push_back(stamps().next());
    aircraft_.publish(makePair(SyntheticRig(), 6, published.back()));
    const auto message = disparity.waitForStamp(published.back());
    ASSERT_TRUE(message);
    EXPECT_FLOAT_EQ(message->max_disparity, range - 1.0F);
  }
  for (const ros::Time& stamp : published) {
    EXPECT_TRUE(disparity.waitForStamp(stamp)) << stamp;
    EXPECT_TRUE(grid_state.waitForStamp(stamp)) << stamp;
  }
}

TEST_F(Contract, CorrectsReconfigurationAndSaysSo) {
  Listener<rosgraph_msgs::Log> log(handle_, "/rosout");
  ASSERT_TRUE(log.waitConnected(3));  // manager, loader, this test
  dynamic_reconfigure::Config config;
  addInt(config, "disparity_range", 41);
  dynamic_reconfigure::Config response;
  ASSERT_TRUE(reconfigure("/stereo/disparity", config, &response));
  const auto value = std::find_if(response.ints.begin(), response.ints.end(),
                                  [](const auto& p) { return p.name == "disparity_range"; });
  ASSERT_NE(value, response.ints.end());
  EXPECT_EQ(value->value, 48) << "written back, so that the user sees it";
  EXPECT_TRUE(logged(log, rosgraph_msgs::Log::WARN, {"disparity_range", "41", "48"}));
  config.ints.clear();
  addInt(config, "disparity_range", 32);
  ASSERT_TRUE(reconfigure("/stereo/disparity", config));
}

/// Publishes a pair with one fault, expects the sentence in the log and the next good frame.
class BadInput : public Contract {
 protected:
  using Change = std::function<void(sensor_msgs::Image&, sensor_msgs::Image&,
                                    sensor_msgs::CameraInfo&, sensor_msgs::CameraInfo&)>;

  void expectRefused(const Change& change, const std::vector<std::string>& words) {
    const ros::Time stamp = stamps().next();
    const StereoPair good = makePair(SyntheticRig(), 6, stamp);
    auto left = boost::make_shared<sensor_msgs::Image>(*good.left);
    auto right = boost::make_shared<sensor_msgs::Image>(*good.right);
    auto left_info = boost::make_shared<sensor_msgs::CameraInfo>(*good.left_info);
    auto right_info = boost::make_shared<sensor_msgs::CameraInfo>(*good.right_info);
    change(*left, *right, *left_info, *right_info);
    aircraft_.publish(StereoPair{left, right, left_info, right_info});
    EXPECT_TRUE(logged(log_, rosgraph_msgs::Log::ERROR, words)) << words.front();
    ASSERT_TRUE(expectServed(disparity_, 6)) << "after: " << words.front();
    for (const auto& message : disparity_.all()) EXPECT_NE(message->header.stamp, stamp);
  }

  void SetUp() override {
    ASSERT_TRUE(log_.waitConnected(3));  // manager, loader, this test
    ASSERT_TRUE(aircraft_.waitSubscribed());
  }

  Listener<rosgraph_msgs::Log> log_{handle_, "/rosout"};
  Listener<DisparityImage> disparity_{handle_, "/stereo/disparity"};
};

TEST_F(BadInput, IsRefusedWithASentenceAndTheNextGoodFrameIsServed) {
  using Image = sensor_msgs::Image;
  using Info = sensor_msgs::CameraInfo;
  expectRefused(
      [](Image&, Image& r, Info&, Info&) {
        r = *makePair({64, 48}, 6, r.header.stamp).right;
      },
      {"/stereo/right/image_rect", "64x48", "128x96"});
  expectRefused([](Image& l, Image&, Info&, Info&) { l.encoding = "bayer_rggb8"; },
                {"/stereo/left/image_rect", "bayer_rggb8", "image_proc"});
  expectRefused([](Image&, Image& r, Info&, Info&) { r.encoding = "32FC1"; },
                {"/stereo/right/image_rect", "32FC1", "mono8"});
  expectRefused([](Image& l, Image&, Info&, Info&) { l.step = 3; },
                {"/stereo/left/image_rect", "step 3"});
  expectRefused([](Image& l, Image&, Info&, Info&) { l.data.resize(7); },
                {"/stereo/left/image_rect", "7 bytes"});
  expectRefused([](Image& l, Image&, Info&, Info&) { l.width = 0x80000000U; },
                {"/stereo/left/image_rect", "2147483648x96"});
  expectRefused([](Image&, Image&, Info& l, Info&) { l.P.fill(0.0); },
                {"/stereo/left/camera_info", "not calibrated"});
  expectRefused([](Image&, Image&, Info&, Info& r) { r.P[2] = std::nan(""); },
                {"/stereo/right/camera_info", "nan"});
  expectRefused([](Image&, Image&, Info&, Info& r) { r.P[3] = 0.0; },
                {"/stereo/right/camera_info", "baseline of 0 m", "parameter baseline"});
  expectRefused([](Image&, Image&, Info&, Info& r) { r.P[3] = 20.0; },
                {"/stereo/right/camera_info", "baseline of -0.2 m", "swapped"});
  expectRefused([](Image&, Image&, Info& l, Info&) { l.P[0] = 50.0; },
                {"/stereo/left/camera_info", "50", "100", "focal length"});
  expectRefused([](Image&, Image&, Info&, Info& r) { r.width = 640; },
                {"/stereo/right/camera_info", "640x96"});
}

TEST_F(BadInput, IsShownByDiagnosticsUntilAGoodPairComes) {
  Listener<diagnostic_msgs::DiagnosticArray> diagnostics(handle_, "/diagnostics");
  const auto calibration = [](const diagnostic_msgs::DiagnosticArray& array, int level,
                              const std::string& words) {
    return std::any_of(array.status.begin(), array.status.end(), [&](const auto& status) {
      return status.name == "stereo/disparity: Calibration" && status.level == level &&
             status.message.find(words) != std::string::npos;
    });
  };
  const ros::Time stamp = stamps().next();
  const StereoPair good = makePair(SyntheticRig(), 6, stamp);
  auto info = boost::make_shared<sensor_msgs::CameraInfo>(*good.right_info);
  info->P[3] = 0.0;
  aircraft_.publish(StereoPair{good.left, good.right, good.left_info, info});
  EXPECT_TRUE(diagnostics.waitFor([&](const auto& array) {
    return calibration(array, diagnostic_msgs::DiagnosticStatus::ERROR, "baseline of 0 m");
  }));
  ASSERT_TRUE(expectServed(disparity_, 6));
  diagnostics.clear();
  EXPECT_TRUE(diagnostics.waitFor([&](const auto& array) {
    return calibration(array, diagnostic_msgs::DiagnosticStatus::OK, "");
  }));
}

TEST_F(BadInput, CountsAsDroppedFrames) {
  Listener<GridState> grid_state(handle_, "/stereo/grid_state");
  ASSERT_TRUE(grid_state.waitConnected());
  ros::Time stamp = stamps().next();
  aircraft_.publish(makePair(SyntheticRig(), 6, stamp));
  const auto before = grid_state.waitForStamp(stamp);
  ASSERT_TRUE(before);
  const StereoPair pair = makePair(SyntheticRig(), 6, stamps().next());
  auto left = boost::make_shared<sensor_msgs::Image>(*pair.left);
  left->encoding = "nonsense";
  aircraft_.publish(StereoPair{left, pair.right, pair.left_info, pair.right_info});
  stamp = stamps().next();
  aircraft_.publish(makePair(SyntheticRig(), 6, stamp));
  const auto after = grid_state.waitForStamp(stamp);
  ASSERT_TRUE(after);
  EXPECT_EQ(after->frames_dropped, before->frames_dropped + 1);
}

TEST_F(Contract, TakesEveryEncodingItPromises) {
  Listener<DisparityImage> disparity(handle_, "/stereo/disparity");
  ASSERT_TRUE(aircraft_.waitSubscribed());
  for (const char* encoding : {"mono8", "8UC1", "bgr8", "rgb8", "bgra8", "rgba8", "mono16"}) {
    const ros::Time stamp = stamps().next();
    const StereoPair pair = makePair(SyntheticRig(), 6, stamp);
    const auto convert = [&](const sensor_msgs::Image& from) {
      cv::Mat grey(96, 128, CV_8UC1, const_cast<std::uint8_t*>(from.data.data()), from.step);
      cv::Mat image = grey;
      const std::string name(encoding);
      if (name == "bgr8" || name == "rgb8") cv::cvtColor(grey, image, cv::COLOR_GRAY2BGR);
      if (name == "bgra8" || name == "rgba8") cv::cvtColor(grey, image, cv::COLOR_GRAY2BGRA);
      if (name == "mono16") grey.convertTo(image, CV_16U, 16.0);  // a 12-bit camera
      return toMessage(image, name, from.header);
    };
    aircraft_.publish(
        StereoPair{convert(*pair.left), convert(*pair.right), pair.left_info, pair.right_info});
    const auto message = disparity.waitForStamp(stamp);
    ASSERT_TRUE(message) << encoding;
    EXPECT_GT(shareAt(*message, 6, 6), 0.9) << encoding;
  }
}

}  // namespace
}  // namespace adaptive_grid_stereo

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "contract_test");
  return RUN_ALL_TESTS();
}
