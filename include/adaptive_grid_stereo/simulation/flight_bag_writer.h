#ifndef ADAPTIVE_GRID_STEREO_SIMULATION_FLIGHT_BAG_WRITER_H
#define ADAPTIVE_GRID_STEREO_SIMULATION_FLIGHT_BAG_WRITER_H

#include <cstdint>
#include <functional>
#include <string>

#include <ros/datatypes.h>
#include <ros/time.h>
#include <rosbag/bag.h>
#include <sensor_msgs/CameraInfo.h>
#include <boost/shared_ptr.hpp>

#include "adaptive_grid_stereo/simulation/renderer.h"
#include "adaptive_grid_stereo/simulation/sensors.h"
#include "adaptive_grid_stereo/simulation/trajectory.h"

namespace adaptive_grid_stereo {
namespace simulation {

/// Rates of what is written [Hz]; the slower ones divide `imu_rate`.
struct FlightBagConfig {
  StereoRig rig;
  double image_rate = 10.0;
  int imu_rate = 200;
  int odometry_rate = 50;
  int magnetic_rate = 50;
  int gps_rate = 5;
  double start_time = 1600000000.0;  // stamp of the flight's start [s]
  bool write_truth = true;           // /ground_truth/*
};

/// Writes a flight into a rosbag, as an autopilot with mavros and a stereo camera would have:
///
/// | topic | type | rate | frame |
/// |---|---|---|---|
/// | /stereo/{left,right}/image_rect | Image mono8 | image_rate | stereo_{left,right}_optical |
/// | /stereo/{left,right}/camera_info | CameraInfo | image_rate | likewise |
/// | /imu | Imu | imu_rate | base_link (FLU), orientation to map (ENU) |
/// | /odom | Odometry | odometry_rate | map, child base_link (FLU) |
/// | /gps/fix, /gps/vel | NavSatFix, TwistStamped | gps_rate | gps; map (ENU) |
/// | /mag | MagneticField [T] | magnetic_rate | base_link (FLU) |
/// | /tf_static | base_link to both optical frames | once, latched | |
/// | /tf | map to base_link | odometry_rate | |
/// | /ground_truth/disparity | DisparityImage of the left view; 0: sky | image_rate | left |
/// | /ground_truth/occlusion | Image mono8: 0 visible, 128 outside the right view, 255 occluded | |
/// | | /ground_truth/odom | Odometry without noise | odometry_rate | as /odom |
class FlightBagWriter {
 public:
  /// Opens `path` for writing. Throws rosbag::BagException.
  FlightBagWriter(const std::string& path, const FlightBagConfig& config);

  /// Called after each frame with the number of frames done.
  using Progress = std::function<void(long)>;

  /// Writes the whole flight and closes the bag. Throws rosbag::BagException.
  void write(const Trajectory& flight, const Sensors& sensors, const Renderer& renderer,
             const Progress& progress);

  /// Frames in `duration` [s]: one at 0 and one each 1 / image_rate before the end.
  static long frameCount(double duration, double image_rate);

 private:
  ros::Time stampAt(double time) const;
  template <typename Message>
  void put(const std::string& topic, const ros::Time& arrival, const Message& message);
  void writeStaticTransforms();
  void writeSensors(const Trajectory& flight, const Sensors& sensors, std::int64_t tick);
  void writeImu(const FlightSample& truth, const Sensors& sensors, std::uint64_t index);
  void writeOdometry(const FlightSample& truth, const Sensors& sensors, std::uint64_t index);
  void writeGps(const FlightSample& truth, const Sensors& sensors, std::uint64_t index);
  void writeMagneticField(const FlightSample& truth, const Sensors& sensors, std::uint64_t index);
  void writeFrame(const StereoFrame& frame, double time);
  void writeTruth(const StereoFrame& frame, const ros::Time& stamp);

  FlightBagConfig config_;
  rosbag::Bag bag_;
  boost::shared_ptr<ros::M_string> latched_;
};

/// What a calibrated, rectified camera of the rig publishes; P[3] = -f B for the right one.
sensor_msgs::CameraInfo makeCameraInfo(const StereoRig& rig, bool right);

}  // namespace simulation
}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SIMULATION_FLIGHT_BAG_WRITER_H
