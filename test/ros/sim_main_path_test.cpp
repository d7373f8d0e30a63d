// The main job, end to end: a simulated flight is recorded, played through the nodelet, and what
// comes out is held against the truth.

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <ros/ros.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/Image.h>
#include <stereo_msgs/DisparityImage.h>

#include "adaptive_grid_stereo/GridState.h"
#include "adaptive_grid_stereo/simulation/flight_bag_writer.h"
#include "adaptive_grid_stereo/simulation/flight_plan.h"
#include "adaptive_grid_stereo/simulation/landscape.h"

namespace adaptive_grid_stereo {
namespace {

constexpr double kDuration = 28.5;   // [s]
constexpr double kImageRate = 5.0;   // [Hz]
constexpr double kPlayRate = 2.0;    // times real time
constexpr double kPatience = 120.0;  // [s]

std::string writeFlight() {
  const std::string path =
      ::testing::TempDir() + "sim_main_path_" + std::to_string(getpid()) + ".bag";
  simulation::FlightBagConfig config;
  config.image_rate = kImageRate;
  simulation::RendererConfig renderer;
  renderer.samples = 4;
  const simulation::Trajectory flight =
      simulation::makeFlight(simulation::manoeuvresFromString("all"), kDuration);
  const simulation::Scene scene(simulation::makeLandscape(flight, simulation::LandscapeConfig()));
  simulation::FlightBagWriter writer(path, config);
  writer.write(flight, simulation::Sensors(simulation::SensorConfig()),
               simulation::Renderer(scene, renderer), nullptr);
  return path;
}

pid_t startPlayer(const std::string& bag) {
  const pid_t child = fork();
  if (child == 0) {
    const std::string rate = std::to_string(kPlayRate);
    execlp("rosbag", "rosbag", "play", "--clock", "--quiet", "-d", "2", "-r", rate.c_str(),
           bag.c_str(), static_cast<char*>(nullptr));
    _exit(127);
  }
  return child;
}

cv::Mat pixelsOf(const sensor_msgs::Image& image, int type) {
  return cv::Mat(static_cast<int>(image.height), static_cast<int>(image.width), type,
                 const_cast<unsigned char*>(image.data.data()), image.step);
}

// Everything that came out of the nodelet, and the truth from the bag, by stamp.
struct Recording {
  std::map<ros::Time, GridStateConstPtr> states;
  std::map<ros::Time, stereo_msgs::DisparityImageConstPtr> disparities;
  std::map<ros::Time, stereo_msgs::DisparityImageConstPtr> truth;
  std::map<ros::Time, sensor_msgs::ImageConstPtr> occlusion;
  std::map<ros::Time, nav_msgs::OdometryConstPtr> motion;
};

class SimulatedFlight : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    recording_ = new Recording;
    const std::string bag = writeFlight();
    readTruth(bag);
    play(bag);
    std::remove(bag.c_str());
  }
  static void TearDownTestSuite() {
    delete recording_;
    recording_ = nullptr;
  }

  static void readTruth(const std::string& path) {
    rosbag::Bag bag(path);
    for (const rosbag::MessageInstance& message : rosbag::View(bag)) {
      if (message.getTopic() == "/ground_truth/disparity") {
        const auto truth = message.instantiate<stereo_msgs::DisparityImage>();
        recording_->truth[truth->header.stamp] = truth;
      } else if (message.getTopic() == "/ground_truth/occlusion") {
        const auto occlusion = message.instantiate<sensor_msgs::Image>();
        recording_->occlusion[occlusion->header.stamp] = occlusion;
      } else if (message.getTopic() == "/ground_truth/odom") {
        const auto odometry = message.instantiate<nav_msgs::Odometry>();
        recording_->motion[odometry->header.stamp] = odometry;
      }
    }
  }

  static void play(const std::string& path) {
    ros::NodeHandle node;
    const boost::function<void(const GridStateConstPtr&)> keepState =
        [](const GridStateConstPtr& state) { recording_->states[state->header.stamp] = state; };
    const boost::function<void(const stereo_msgs::DisparityImageConstPtr&)> keepDisparity =
        [](const stereo_msgs::DisparityImageConstPtr& disparity) {
          recording_->disparities[disparity->header.stamp] = disparity;
        };
    const ros::Subscriber state_subscriber =
        node.subscribe<GridState>("/stereo/grid_state", 1000, keepState);
    const ros::Subscriber disparity_subscriber =
        node.subscribe<stereo_msgs::DisparityImage>("/stereo/disparity", 1000, keepDisparity);

    const ros::WallTime deadline = ros::WallTime::now() + ros::WallDuration(kPatience);
    while (state_subscriber.getNumPublishers() == 0 && ros::WallTime::now() < deadline) wait();
    ASSERT_GT(state_subscriber.getNumPublishers(), 0u) << "the nodelet did not start";
    const pid_t player = startPlayer(path);
    int status = 0;
    bool playing = true;
    ros::WallTime end = deadline;
    while (ros::ok() && ros::WallTime::now() < end && !isComplete()) {
      wait();
      if (playing && waitpid(player, &status, WNOHANG) == player) {
        playing = false;
        end = std::min(deadline, ros::WallTime::now() + ros::WallDuration(20.0));
      }
    }
    if (playing) waitpid(player, &status, 0);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << "rosbag play failed";
  }

  static void wait() {
    ros::spinOnce();
    ros::WallDuration(0.01).sleep();
  }

  static bool isComplete() {
    return recording_->states.size() >= recording_->truth.size() &&
           recording_->disparities.size() >= recording_->truth.size();
  }

  static Recording* recording_;
};
Recording* SimulatedFlight::recording_ = nullptr;

std::string nameOf(const GridState& state) {
  if (!state.motion_valid) return "UNKNOWN";
  if (state.state & GridState::LOCKED) return "LOCKED";
  std::string name = state.state & GridState::FORWARD ? "FORWARD" : "NONE";
  if (state.state & GridState::YAW) name += state.yaw_rate > 0 ? " left" : " right";
  if (state.state & GridState::PITCH) name += state.pitch_rate > 0 ? " up" : " down";
  return name;
}

TEST_F(SimulatedFlight, EveryFrameComesOut) {
  EXPECT_EQ(recording_->truth.size(), static_cast<std::size_t>(std::ceil(kDuration * kImageRate)));
  for (const auto& [stamp, truth] : recording_->truth) {
    EXPECT_EQ(recording_->states.count(stamp), 1u) << "no grid_state at " << stamp;
    EXPECT_EQ(recording_->disparities.count(stamp), 1u) << "no disparity at " << stamp;
  }
}

TEST_F(SimulatedFlight, StatesComeInTheFlightsOrder) {
  std::vector<std::string> names;
  std::string all;
  for (const auto& [stamp, state] : recording_->states) {
    if (names.empty() || names.back() != nameOf(*state)) {
      names.push_back(nameOf(*state));
      all += names.back() + "; ";
    }
  }
  std::size_t next = 0;
  const std::vector<std::string> expected{
      "LOCKED",  "FORWARD",    "FORWARD left", "FORWARD",      "FORWARD right",
      "FORWARD", "FORWARD up", "FORWARD",      "FORWARD down", "FORWARD left up"};
  for (const std::string& name : names) {
    if (next < expected.size() && name == expected[next]) ++next;
  }
  EXPECT_EQ(next, expected.size()) << all;
}

TEST_F(SimulatedFlight, MotionIsTheTrueOne) {
  ASSERT_FALSE(recording_->states.empty());
  double speed_error = 0.0;
  double yaw_error = 0.0;
  double pitch_error = 0.0;
  int count = 0;
  for (const auto& [stamp, state] : recording_->states) {
    ASSERT_EQ(recording_->motion.count(stamp), 1u);
    const geometry_msgs::Twist& twist = recording_->motion[stamp]->twist.twist;
    if (!state->motion_valid) continue;
    ++count;
    speed_error += std::abs(state->forward_speed - twist.linear.x);
    yaw_error += std::abs(state->yaw_rate - twist.angular.z);      // body z is up: left positive
    pitch_error += std::abs(state->pitch_rate + twist.angular.y);  // body y is left: nose down
  }
  // The first frames may come before the first motion has arrived.
  EXPECT_GE(count, static_cast<int>(recording_->states.size()) - 3);
  EXPECT_LT(speed_error / count, 0.15);
  EXPECT_LT(yaw_error / count, 0.03);  // the low-pass follows a little late
  EXPECT_LT(pitch_error / count, 0.03);
}

TEST_F(SimulatedFlight, FocusLiesWhereTheAircraftTurns) {
  int turns = 0;
  for (const auto& [stamp, state] : recording_->states) {
    const auto& paths = state->paths;
    if (nameOf(*state) == "FORWARD left") {
      ++turns;
      for (const int row : {0, 3, 6}) {
        EXPECT_EQ(paths[row], 16);
        EXPECT_EQ(paths[row + 1], 8);
        EXPECT_EQ(paths[row + 2], 4);
      }
    } else if (nameOf(*state) == "FORWARD up") {
      ++turns;
      for (const int column : {0, 1, 2}) {
        EXPECT_EQ(paths[column], 16);
        EXPECT_EQ(paths[3 + column], 8);
        EXPECT_EQ(paths[6 + column], 4);
      }
    }
  }
  EXPECT_GT(turns, 10);
}

TEST_F(SimulatedFlight, DisparityIsCloseToTheTruth) {
  double counted = 0;
  double bad = 0;
  double valid = 0;
  double error_sum = 0;
  for (const auto& [stamp, message] : recording_->disparities) {
    ASSERT_EQ(recording_->truth.count(stamp), 1u);
    const cv::Mat truth = pixelsOf(recording_->truth[stamp]->image, CV_32FC1);
    const cv::Mat hidden = pixelsOf(*recording_->occlusion[stamp], CV_8UC1);
    const cv::Mat disparity = pixelsOf(message->image, CV_32FC1);
    ASSERT_EQ(disparity.size(), truth.size());
    for (int row = 0; row < truth.rows; ++row) {
      for (int column = 0; column < truth.cols; ++column) {
        const float expected = truth.at<float>(row, column);
        if (expected <= 0.0f || hidden.at<unsigned char>(row, column) != 0) continue;
        ++counted;
        const float found = disparity.at<float>(row, column);
        if (found < message->min_disparity) {
          ++bad;
          continue;
        }
        ++valid;
        error_sum += std::abs(found - expected);
        bad += std::abs(found - expected) > 2.0f ? 1 : 0;
      }
    }
  }
  ASSERT_GT(counted, 1e6);
  EXPECT_LT(bad / counted, 0.06) << "share of visible pixels that are invalid or off by 2 px";
  EXPECT_LT(error_sum / valid, 0.5) << "mean error of valid pixels [px]";
  EXPECT_GT(valid / counted, 0.9);
}

}  // namespace
}  // namespace adaptive_grid_stereo

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "sim_main_path_test");
  return RUN_ALL_TESTS();
}
