#include "adaptive_grid_stereo/ros/overlay.h"

#include <limits>

#include <gtest/gtest.h>

namespace adaptive_grid_stereo {
namespace {

GridState makeState(int width, int height) {
  GridState state;
  state.motion_valid = 1;
  state.state = GridState::FORWARD | GridState::YAW;
  state.forward_speed = 12.0;
  state.yaw_rate = 0.4;
  state.column_edges = {0, width / 3, 2 * width / 3, width};
  state.row_edges = {0, height / 3, 2 * height / 3, height};
  state.paths = {16, 8, 4, 16, 8, 4, 16, 8, 4};
  return state;
}

/// Mean colour of a patch between a cell's number and its frame.
cv::Scalar colorAt(const cv::Mat& picture, double x, double y) {
  const cv::Rect patch(static_cast<int>(x * picture.cols) - 3,
                       static_cast<int>(y * picture.rows) - 3, 7, 7);
  return cv::mean(picture(patch));
}

TEST(Overlay, TintsTheCellsByTheirPaths) {
  const cv::Mat grey(360, 640, CV_8UC1, cv::Scalar(128));
  const cv::Mat picture = drawGridOverlay(grey, makeState(640, 360));
  ASSERT_EQ(picture.type(), CV_8UC3);
  ASSERT_EQ(picture.size(), grey.size());
  const cv::Scalar many = colorAt(picture, 0.06, 0.5);
  const cv::Scalar few = colorAt(picture, 0.94, 0.5);
  EXPECT_GT(many[1], many[0]) << "16 paths: green";
  EXPECT_GT(few[0], few[2]) << "4 paths: blue";
}

TEST(Overlay, NamesTheSideOfTheFocusWhateverTheRateIsByNow) {
  const cv::Mat grey(360, 640, CV_8UC1, cv::Scalar(128));
  const auto topBar = [&](double yaw_rate, bool mirrored) {
    GridState state = makeState(640, 360);
    state.yaw_rate = yaw_rate;
    if (mirrored) state.paths = {4, 8, 16, 4, 8, 16, 4, 8, 16};
    return cv::Mat(drawGridOverlay(grey, state).rowRange(0, 12));
  };
  EXPECT_EQ(cv::norm(topBar(0.4, false), topBar(-0.4, false), cv::NORM_INF), 0.0);
  EXPECT_GT(cv::norm(topBar(0.4, false), topBar(0.4, true), cv::NORM_INF), 0.0);
}

TEST(Overlay, EnlargesSmallPicturesByAWholeFactor) {
  EXPECT_EQ(overlayScale(256), 3);
  EXPECT_EQ(overlayScale(640), 1);
  EXPECT_EQ(overlayScale(1280), 1);
  EXPECT_EQ(overlayScale(0), 1);
  const cv::Mat grey(144, 256, CV_8UC1, cv::Scalar(128));
  EXPECT_EQ(drawGridOverlay(grey, makeState(256, 144), 3).size(), cv::Size(768, 432));
}

TEST(Overlay, TakesColourAndLeavesTheInputAlone) {
  const cv::Mat color(120, 160, CV_8UC3, cv::Scalar(10, 20, 30));
  const cv::Mat before = color.clone();
  drawGridOverlay(color, makeState(160, 120));
  EXPECT_EQ(cv::norm(color, before, cv::NORM_INF), 0.0);
}

TEST(Overlay, SurvivesAnyState) {
  const cv::Mat grey(48, 64, CV_8UC1, cv::Scalar(128));
  GridState state;  // all zero: no cell at all
  EXPECT_EQ(drawGridOverlay(grey, state).size(), grey.size());
  state.column_edges = {-1000, 2147483647, -2147483647, 5};
  state.row_edges = {40, 20, 100000, -7};
  state.paths.fill(255);
  state.forward_speed = std::numeric_limits<double>::quiet_NaN();
  state.yaw_rate = std::numeric_limits<double>::infinity();
  state.motion_valid = 1;
  EXPECT_EQ(drawGridOverlay(grey, state).size(), grey.size());
  state.motion_valid = 0;
  state.motion_status = std::string(5000, 'x');
  EXPECT_EQ(drawGridOverlay(grey, state, 2).size(), cv::Size(128, 96));
  const cv::Mat tiny(16, 16, CV_8UC1, cv::Scalar(0));
  EXPECT_EQ(drawGridOverlay(tiny, makeState(16, 16)).size(), tiny.size());
}

}  // namespace
}  // namespace adaptive_grid_stereo
