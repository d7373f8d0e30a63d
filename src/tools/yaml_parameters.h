#ifndef ADAPTIVE_GRID_STEREO_TOOLS_YAML_PARAMETERS_H
#define ADAPTIVE_GRID_STEREO_TOOLS_YAML_PARAMETERS_H

#include <string>

#include "adaptive_grid_stereo/ros/parameters.h"

namespace adaptive_grid_stereo {

/// The values of a YAML file as `rosparam load` would put them into the node's name space, angles
/// in deg(...) and rad(...) included. Throws std::runtime_error, naming the file, if it cannot be
/// read or holds no map.
ParameterValues readYamlParameters(const std::string& path);

/// One value as YAML writes it: `true`, `12`, `0.5`, `deg(3)` [rad], `[0, 0.1, 0]`, `word`; a list
/// of numbers also without brackets. Throws std::runtime_error if it is neither.
XmlRpc::XmlRpcValue parseYamlValue(const std::string& text);

/// The same for the option of a node's parameter. Throws UsageError, naming the option and what it
/// expects, if the parameter cannot take the value.
XmlRpc::XmlRpcValue parseParameterOption(const std::string& parameter, const std::string& text);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_TOOLS_YAML_PARAMETERS_H
