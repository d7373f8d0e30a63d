#include <gtest/gtest.h>
#include <sensor_msgs/image_encodings.h>

#include "adaptive_grid_stereo/ros/stereo_pairing.h"
#include "bag_topics.h"
#include "command_line.h"
#include "grid_state_csv.h"
#include "rectifier.h"
#include "temporary_folder.h"
#include "yaml_parameters.h"

namespace adaptive_grid_stereo {
namespace {

std::vector<BagConnection> connections(
    const std::vector<std::pair<std::string, std::string>>& topics) {
  std::vector<BagConnection> result;
  for (const auto& [topic, type] : topics) {
    BagConnection connection;
    connection.topic = topic;
    connection.datatype = type;
    result.push_back(connection);
  }
  return result;
}

const std::vector<std::pair<std::string, std::string>> kStereo{
    {"/stereo/left/image_raw", "sensor_msgs/Image"},
    {"/stereo/right/image_raw", "sensor_msgs/Image"},
    {"/stereo/left/camera_info", "sensor_msgs/CameraInfo"},
    {"/stereo/right/camera_info", "sensor_msgs/CameraInfo"}};

TEST(BagTopics, TheOnlyPairAndSensorsAreFound) {
  auto topics = kStereo;
  topics.emplace_back("/mavros/imu/data", "sensor_msgs/Imu");
  topics.emplace_back("/mavros/imu/data_raw", "sensor_msgs/Imu");
  topics.emplace_back("/ground_truth/odom", "nav_msgs/Odometry");
  topics.emplace_back("/front/depth", "sensor_msgs/Image");
  std::vector<std::string> notes;
  const BagTopics found = chooseTopics(connections(topics), NamedTopics(), &notes);
  EXPECT_EQ(found.left_image, "/stereo/left/image_raw");
  EXPECT_EQ(found.right_info, "/stereo/right/camera_info");
  EXPECT_EQ(found.motion.imu, "/mavros/imu/data");
  EXPECT_EQ(found.motion.odom, "");
  EXPECT_TRUE(notes.empty());
  EXPECT_EQ(outputNamespace(found.left_image), "/stereo");
  EXPECT_EQ(outputNamespace("/left/image_rect"), "");
  EXPECT_EQ(outputNamespace("/uav/cam0/image_raw"), "/uav");
}

TEST(BagTopics, RectifiedImagesComeFirst) {
  auto topics = kStereo;
  topics.emplace_back("/stereo/left/image_rect", "sensor_msgs/Image");
  topics.emplace_back("/stereo/right/image_rect", "sensor_msgs/Image");
  std::vector<std::string> notes;
  EXPECT_EQ(chooseTopics(connections(topics), NamedTopics(), &notes).left_image,
            "/stereo/left/image_rect");
}

TEST(BagTopics, DoubtsAreSaid) {
  auto topics = kStereo;
  topics.emplace_back("/a", "sensor_msgs/Imu");
  topics.emplace_back("/b", "sensor_msgs/Imu");
  std::vector<std::string> notes;
  EXPECT_EQ(chooseTopics(connections(topics), NamedTopics(), &notes).motion.imu, "");
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("--imu"), std::string::npos);
  NamedTopics named;
  named.imu = "/b";
  EXPECT_EQ(chooseTopics(connections(topics), named, &notes).motion.imu, "/b");
  named.imu = "/stereo/left/image_raw";
  EXPECT_NE(messageOf([&] {
              chooseTopics(connections(topics), named, &notes);
            }).find("sensor_msgs/Image"),
            std::string::npos);
  topics.emplace_back("/down/left/image_raw", "sensor_msgs/Image");
  topics.emplace_back("/down/right/image_raw", "sensor_msgs/Image");
  EXPECT_NE(messageOf([&] {
              chooseTopics(connections(topics), NamedTopics(), &notes);
            }).find("--left-image"),
            std::string::npos);
  EXPECT_NE(messageOf([&] { chooseTopics({}, NamedTopics(), &notes); }).find("no stereo pair"),
            std::string::npos);
}

TEST(BagTopics, CompressedImagesAreNamedWithTheirCure) {
  const auto bag = connections({{"/rig/left/image_raw/compressed", "sensor_msgs/CompressedImage"},
                                {"/rig/right/image_raw/compressed", "sensor_msgs/CompressedImage"},
                                {"/depth", "sensor_msgs/Image"}});
  NamedTopics named;
  const auto fault = [&] { return messageOf([&] { chooseImageTopics(bag, named); }); };
  const std::string cure = "republish compressed in:=/rig/left/image_raw raw";
  EXPECT_NE(fault().find("/rig/right/image_raw/compressed"), std::string::npos) << fault();
  EXPECT_NE(fault().find(cure), std::string::npos) << fault();
  named.left_image = "/rig/left/image_raw/compressed";
  EXPECT_NE(fault().find(cure), std::string::npos) << fault();
  EXPECT_EQ(compressedImages(connections(kStereo)), "");
}

MotionTopics motionTopics(const std::vector<std::pair<std::string, std::string>>& topics) {
  std::vector<std::string> notes;
  const MotionTopics found = chooseMotionTopics(connections(topics), NamedTopics(), &notes);
  EXPECT_TRUE(notes.empty()) << notes.front();
  return found;
}

TEST(BagTopics, WhatIsCommandedOrSimulatedIsNoSensor) {
  const char kTwist[] = "geometry_msgs/TwistStamped", kOdometry[] = "nav_msgs/Odometry";
  for (const char* topic :
       {"/mavros/setpoint_velocity/cmd_vel", "/uav/cmd_vel", "/uav/DesiredVelocity",
        "/mavros/target_velocity", "/gazebo/GroundTruth/twist"}) {
    EXPECT_EQ(motionTopics({{topic, kTwist}}).gps_vel, "") << topic;
    EXPECT_EQ(motionTopics({{topic, kTwist}, {"/gps/vel", kTwist}}).gps_vel, "/gps/vel") << topic;
  }
  EXPECT_EQ(motionTopics({{"/uav/ground_truth/odom", kOdometry}}).odom, "");
  NamedTopics named;
  named.odom = "/uav/ground_truth/odom";
  std::vector<std::string> notes;
  EXPECT_EQ(chooseMotionTopics(connections({{*named.odom, kOdometry}}), named, &notes).odom,
            *named.odom);
}

TEST(BagTopics, AVelocityOfTheBodyIsTakenOnlyWhereItIsNamed) {
  const std::string topic = "/mavros/local_position/velocity_body";
  EXPECT_EQ(motionTopics({{topic, "geometry_msgs/TwistStamped"}}).gps_vel, "");
}

TEST(BagTopics, TheBetterSourceOfAFlightStackIsTaken) {
  const MotionTopics found =
      motionTopics({{"/mavros/imu/data", "sensor_msgs/Imu"},
                    {"/mavros/imu/data_raw", "sensor_msgs/Imu"},
                    {"/mavros/global_position/local", "nav_msgs/Odometry"},
                    {"/mavros/local_position/odom", "nav_msgs/Odometry"},
                    {"/mavros/odometry/in", "nav_msgs/Odometry"},
                    {"/mavros/global_position/raw/gps_vel", "geometry_msgs/TwistStamped"},
                    {"/mavros/local_position/velocity_local", "geometry_msgs/TwistStamped"},
                    {"/mavros/setpoint_velocity/cmd_vel", "geometry_msgs/TwistStamped"},
                    {"/mavros/global_position/global", "sensor_msgs/NavSatFix"},
                    {"/mavros/global_position/raw/fix", "sensor_msgs/NavSatFix"}});
  EXPECT_EQ(found.imu, "/mavros/imu/data");
  EXPECT_EQ(found.odom, "/mavros/local_position/odom");
  EXPECT_EQ(found.gps_vel, "/mavros/global_position/raw/gps_vel");
  EXPECT_EQ(found.gps_fix, "/mavros/global_position/raw/fix");
}

NamedTopics parseTopics(std::vector<const char*> arguments) {
  arguments.insert(arguments.begin(), "tool");
  NamedTopics named;
  boost::program_options::options_description options;
  options.add(imageTopicOptions(&named)).add(motionTopicOptions(&named));
  boost::program_options::variables_map values;
  parseCommandLine(static_cast<int>(arguments.size()), arguments.data(), {"tool", "", "", ""},
                   options, {}, &values);
  return named;
}

TEST(BagTopics, OptionsNameTopics) {
  EXPECT_EQ(parseTopics({"--left-image", "/a"}).left_image, "/a");
  EXPECT_EQ(parseTopics({"--right-info-topic", "/b"}).right_info, "/b");
  EXPECT_EQ(parseTopics({"--gps-vel", "/c"}).gps_vel, "/c");
  EXPECT_EQ(parseTopics({"--gps-vel-topic", "/c"}).gps_vel, "/c");
  EXPECT_EQ(parseTopics({"--imu", "none"}).imu, "");
  EXPECT_EQ(parseTopics({"--imu", ""}).imu, "");
  EXPECT_FALSE(parseTopics({}).imu.has_value());
}

template <typename Message>
boost::shared_ptr<const Message> stamped(double stamp) {
  const auto message = boost::make_shared<Message>();
  message->header.stamp = ros::Time(stamp);
  return message;
}

TEST(StereoPairing, PairsByStampWithTheTimeOfTheLeftImage) {
  ros::Time::init();
  std::vector<std::pair<double, double>> pairs;
  int jumps = 0;
  StereoPairing assembler(
      PairingOptions(),
      [&](const ReceivedPair& pair) {
        pairs.emplace_back(pair.pair.left->header.stamp.toSec(), pair.received.toSec());
      },
      [&](const ros::Time& stamp) {
        EXPECT_EQ(stamp, ros::Time(3.0));
        ++jumps;
      });
  const auto feed = [&](double stamp, double recorded) {
    assembler.addRightInfo(stamped<sensor_msgs::CameraInfo>(stamp), ros::Time(recorded + 0.1));
    assembler.addLeft(stamped<sensor_msgs::Image>(stamp), ros::Time(recorded));
    assembler.addRight(stamped<sensor_msgs::Image>(stamp), ros::Time(recorded + 0.2));
    assembler.addLeftInfo(stamped<sensor_msgs::CameraInfo>(stamp), ros::Time(recorded + 0.3));
  };
  feed(10.0, 50.0);
  feed(10.1, 50.1);
  feed(10.1, 50.2);  // twice: dropped
  feed(3.0, 60.0);   // starts over
  EXPECT_EQ(pairs,
            (std::vector<std::pair<double, double>>{{10.0, 50.0}, {10.1, 50.1}, {3.0, 60.0}}));
  EXPECT_EQ(jumps, 1);
  EXPECT_EQ(assembler.dropped(), 1);
}

sensor_msgs::CameraInfo calibration(unsigned width, unsigned height) {
  sensor_msgs::CameraInfo info;
  info.width = width;
  info.height = height;
  info.distortion_model = "plumb_bob";
  info.D.assign(5, 0.0);
  info.K = {50, 0, width / 2.0, 0, 50, height / 2.0, 0, 0, 1};
  info.R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.P = {50, 0, width / 2.0, 0, 0, 50, height / 2.0, 0, 0, 0, 1, 0};
  return info;
}

TEST(Rectifier, SeesWhatIsRaw) {
  sensor_msgs::CameraInfo info = calibration(32, 24);
  EXPECT_FALSE(needsRectification("/left/image_raw", info));
  info.D[0] = -0.2;
  EXPECT_TRUE(needsRectification("/left/image_raw", info));
  EXPECT_FALSE(needsRectification("/left/image_rect", info));
  info.D[0] = 0.0;
  info.R[1] = 0.01;
  EXPECT_TRUE(needsRectification("/left/image_raw", info));
  info.R.fill(0.0);
  EXPECT_FALSE(needsRectification("/left/Scene", info));
}

TEST(Rectifier, ShiftsThePrincipalPointAndRefusesWrongSizes) {
  auto image = boost::make_shared<sensor_msgs::Image>();
  image->width = 32;
  image->height = 24;
  image->step = 32;
  image->encoding = sensor_msgs::image_encodings::MONO8;
  image->data.resize(32 * 24);
  for (unsigned i = 0; i < image->data.size(); ++i)
    image->data[i] = static_cast<unsigned char>(i % 32);
  sensor_msgs::CameraInfo info = calibration(32, 24);
  info.P[2] += 4.0;
  info.D[4] = 1e-12;  // so that it counts as distorted
  Rectifier rectifier;
  const sensor_msgs::ImageConstPtr rectified = rectifier.rectify(image, info);
  ASSERT_EQ(rectified->width, 32u);
  EXPECT_EQ(rectified->encoding, "mono8");
  EXPECT_NEAR(rectified->data[12 * rectified->step + 20], 16, 1);
  info.width = 64;
  EXPECT_NE(messageOf([&] { rectifier.rectify(image, info); }).find("64x24"), std::string::npos);
  image->data.resize(5);
  EXPECT_NE(messageOf([&] { rectifier.rectify(image, info); }).find("fewer bytes"),
            std::string::npos);
}

TEST(GridStateCsv, OneValuePerColumn) {
  GridState state;
  state.header.stamp = ros::Time(12, 5);
  state.paths[8] = 4;
  state.forward_speed = 12.25;
  const std::string line = toCsvLine(state);
  const std::string header = gridStateCsvHeader();
  EXPECT_EQ(std::count(line.begin(), line.end(), ','),
            std::count(header.begin(), header.end(), ','));
  EXPECT_EQ(line.substr(0, 13), "12.000000005,");
  EXPECT_NE(line.find(",12.25,"), std::string::npos);
  EXPECT_NE(header.find(",column_edges_0,"), std::string::npos);
  EXPECT_NE(header.find(",paths_9,"), std::string::npos);
}

TEST(YamlParameters, ValuesAsRosparamWouldLoadThem) {
  const TemporaryFolder folder;
  folder.write("a.yaml",
               "# comment\nmax_speed: 25\nsigma1: 0.4\nsubpixel: false\ncensus_window: 5x5\n"
               "camera_rpy: [0, -0.1, 0.0]\nbody_frame: \"12\"\n");
  std::vector<std::string> warnings;
  const NodeConfig config = readNodeConfig(readYamlParameters(folder.file("a.yaml")), warnings);
  EXPECT_TRUE(warnings.empty()) << warnings.front();
  EXPECT_DOUBLE_EQ(config.processor.guidance.max_speed, 25.0);
  EXPECT_DOUBLE_EQ(config.processor.guidance.sigma1, 0.4);
  EXPECT_FALSE(config.processor.matcher.subpixel);
  EXPECT_EQ(config.processor.matcher.census_window, CensusWindow::k5x5);
  EXPECT_DOUBLE_EQ(config.motion.camera_rpy[1], -0.1);
  EXPECT_EQ(config.motion.body_frame, "12");
}

double number(const std::string& text) { return static_cast<double>(parseYamlValue(text)); }

TEST(YamlParameters, AnglesAsRosparamHasThem) {
  const TemporaryFolder folder;
  folder.write("a.yaml", "magnetic_declination: deg(3)\ncamera_rpy: [0, deg(-20.5), rad(pi/2)]\n");
  std::vector<std::string> warnings;
  const NodeConfig config = readNodeConfig(readYamlParameters(folder.file("a.yaml")), warnings);
  EXPECT_TRUE(warnings.empty()) << warnings.front();
  EXPECT_DOUBLE_EQ(config.motion.magnetic_declination, 3.0 * M_PI / 180.0);
  EXPECT_DOUBLE_EQ(config.motion.camera_rpy[1], -20.5 * M_PI / 180.0);
  EXPECT_DOUBLE_EQ(config.motion.camera_rpy[2], M_PI / 2.0);
  EXPECT_DOUBLE_EQ(number("rad(-3 * pi / 4)"), -0.75 * M_PI);
  EXPECT_DOUBLE_EQ(number("rad(0.25)"), 0.25);
  for (const char* text : {"deg()", "deg(x)", "rad(pi/0)", "rad(po)", "rad(1+1)", "deg(3 4)"}) {
    EXPECT_NE(messageOf([&] { parseYamlValue(text); }).find("is no angle"), std::string::npos)
        << text;
  }
}

TEST(YamlParameters, OptionsTakeListsInBothSpellingsAndRefuseTheRest) {
  for (const char* text : {"0,0.3,0", "[0,0.3,0]", "0, 0.3, rad(0)"}) {
    XmlRpc::XmlRpcValue list = parseParameterOption("camera_rpy", text);
    ASSERT_EQ(list.size(), 3) << text;
    EXPECT_DOUBLE_EQ(static_cast<double>(list[1]), 0.3) << text;
  }
  EXPECT_EQ(static_cast<std::string>(parseParameterOption("body_frame", "a,1")), "a,1");
  for (const char* text : {"0,0.3", "0,x,0", "0.3", "[0,0.3,0", "0,,0"}) {
    EXPECT_THROW(parseParameterOption("camera_rpy", text), UsageError) << text;
  }
  EXPECT_NE(messageOf([] {
              parseParameterOption("max_speed", "fast");
            }).find("--max-speed 'fast': expected a number"),
            std::string::npos);
}

TEST(YamlParameters, DamagedFilesAreNamed) {
  const TemporaryFolder folder;
  folder.write("a.yaml", "a: [1, 2\n");
  EXPECT_NE(messageOf([&] { readYamlParameters(folder.file("a.yaml")); }).find("a.yaml"),
            std::string::npos);
  folder.write("b.yaml", "- 1\n- 2\n");
  EXPECT_NE(messageOf([&] { readYamlParameters(folder.file("b.yaml")); }).find("name: value"),
            std::string::npos);
  folder.write("c.yaml", "a: {b: 1}\n");
  EXPECT_NE(messageOf([&] { readYamlParameters(folder.file("c.yaml")); }).find("parameter a"),
            std::string::npos);
}

}  // namespace
}  // namespace adaptive_grid_stereo
