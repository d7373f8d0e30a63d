#include <cstdio>
#include <string>

#include <nodelet/loader.h>
#include <ros/ros.h>

/// The nodelet in a process of its own.
int main(int argc, char** argv) {
  ros::init(argc, argv, "disparity");
  if (ros::names::remap("left/image_rect") == "left/image_rect" &&
      ros::this_node::getNamespace() == "/") {
    ROS_WARN(
        "started in the global name space: the inputs are /left/image_rect and so on. Usually the "
        "node belongs into the camera's: ROS_NAMESPACE=stereo rosrun adaptive_grid_stereo "
        "adaptive_grid_stereo_node");
  }
  nodelet::Loader loader;
  const nodelet::M_string remappings(ros::names::getRemappings());
  const nodelet::V_string arguments(argv + 1, argv + argc);
  if (!loader.load(ros::this_node::getName(), "adaptive_grid_stereo/disparity", remappings,
                   arguments)) {
    ROS_FATAL(
        "the nodelet adaptive_grid_stereo/disparity could not be loaded; is the package's "
        "setup.bash "
        "sourced?");
    return 1;
  }
  ros::spin();
  return 0;
}
