#ifndef ADAPTIVE_GRID_STEREO_ROS_PARAMETERS_H
#define ADAPTIVE_GRID_STEREO_ROS_PARAMETERS_H

#include <map>
#include <string>
#include <vector>

#include <XmlRpcValue.h>
#include <ros/node_handle.h>

#include "adaptive_grid_stereo/DisparityConfig.h"
#include "adaptive_grid_stereo/guidance/motion_config.h"
#include "adaptive_grid_stereo/ros/frame_processor.h"
#include "adaptive_grid_stereo/ros/parameter_visitor.h"

namespace adaptive_grid_stereo {

/// Every parameter of the nodelet, with the package's defaults.
struct NodeConfig {
  ProcessorConfig processor;
  MotionConfig motion;

  /// Pair images whose stamps differ (approximate), or only equal ones (exact).
  bool approximate_sync = false;
  /// Largest difference of the stamps of a pair [s], 0..10; 0: no limit.
  double approximate_sync_max_interval = 0.02;
  /// Messages kept per input while waiting for their partners, 1..1000.
  int queue_size = 5;
  /// Overrides the camera_info's baseline [m], 0..100; 0: camera_info.
  double baseline = 0.0;
  /// Transport of both image inputs, e.g. "raw" or "compressed".
  std::string image_transport = "raw";
  /// Subscribe to the inputs only while somebody listens to an output.
  bool lazy = true;
  /// Process every pair in order instead of the newest (for recordings).
  bool process_every_frame = false;
  /// Rate of pairs [Hz] below nine tenths of which diagnostics warn, 0..1000; 0: none expected.
  double expected_rate = 0.0;
  /// Share of valid pixels below which diagnostics warn [1], 0..1.
  double min_density = 0.1;

  /// Brings every value into its legal range and returns one sentence per value that was changed.
  std::vector<std::string> validate();
};

/// As the functions of parameter_visitor.h, for what stands in ProcessorConfig and NodeConfig only.
template <typename Config, typename Visitor>
void visitNodeParameters(Config& config, Visitor&& visit) {
  visit("approximate_sync", config.approximate_sync);
  visit("approximate_sync_max_interval", config.approximate_sync_max_interval);
  visit("queue_size", config.queue_size);
  visit("baseline", config.baseline);
  visit("image_transport", config.image_transport);
  visit("lazy", config.lazy);
  visit("process_every_frame", config.process_every_frame);
  visit("expected_rate", config.expected_rate);
  visit("min_density", config.min_density);
  visit("mono16_bits", config.processor.mono16_bits);
  visit("target_period", config.processor.target_period);
}

/// All parameters of the node.
template <typename Config, typename Visitor>
void visitAllParameters(Config& config, Visitor&& visit) {
  visitNodeParameters(config, visit);
  visitMatcherParameters(config.processor.matcher, visit);
  visitGuidanceParameters(config.processor.guidance, visit);
  visitMotionParameters(config.motion, visit);
}

/// Raw values by name, as from the parameter server or a YAML file.
using ParameterValues = std::map<std::string, XmlRpc::XmlRpcValue>;

/// Config from raw values; what is missing keeps its default. One sentence goes to `warnings` for
/// each value of a wrong type or out of range (with the value used), for each unknown name, and
/// once for the names that only SGBM of stereo_image_proc knows. Never throws.
NodeConfig readNodeConfig(const ParameterValues& values, std::vector<std::string>& warnings);

/// What the parameter `name` expects instead of a value, e.g. "a number"; "" if it can be read, or
/// there is no such parameter.
std::string expectedInstead(const std::string& name, const XmlRpc::XmlRpcValue& value);

/// All that stands below the private name space, without those of deeper name spaces.
ParameterValues privateParameters(const ros::NodeHandle& private_handle);

/// The effective parameters, "name: value" each, for the log.
std::string toString(const NodeConfig& config);

/// The dynamically reconfigurable part of a config, and back. Values that are out of range come
/// back corrected, with one sentence each in `warnings`.
DisparityConfig toReconfigure(const ProcessorConfig& config);
ProcessorConfig fromReconfigure(const DisparityConfig& reconfigure, const ProcessorConfig& before,
                                std::vector<std::string>& warnings);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_ROS_PARAMETERS_H
