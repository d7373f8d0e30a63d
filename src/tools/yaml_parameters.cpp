#include "yaml_parameters.h"

#include <stdexcept>

#include <yaml-cpp/yaml.h>

namespace adaptive_grid_stereo {
namespace {

XmlRpc::XmlRpcValue toValue(const YAML::Node& node) {
  if (node.IsSequence()) {
    XmlRpc::XmlRpcValue list;
    list.setSize(0);
    int i = 0;
    for (const YAML::Node& element : node) list[i++] = toValue(element);
    return list;
  }
  if (!node.IsScalar()) throw std::runtime_error("expected a value or a list");
  // A quoted scalar is a string, whatever it looks like.
  if (node.Tag() == "!") return XmlRpc::XmlRpcValue(node.Scalar());
  bool truth = false;
  int whole = 0;
  double number = 0.0;
  if (YAML::convert<int>::decode(node, whole)) return XmlRpc::XmlRpcValue(whole);
  if (YAML::convert<double>::decode(node, number)) return XmlRpc::XmlRpcValue(number);
  if (YAML::convert<bool>::decode(node, truth)) return XmlRpc::XmlRpcValue(truth);
  return XmlRpc::XmlRpcValue(node.Scalar());
}

}  // namespace

ParameterValues readYamlParameters(const std::string& path) {
  ParameterValues values;
  try {
    const YAML::Node root = YAML::LoadFile(path);
    if (root.IsNull()) return values;
    if (!root.IsMap()) throw std::runtime_error("expected lines of the form 'name: value'");
    for (const auto& entry : root) {
      const std::string name = entry.first.as<std::string>();
      try {
        values[name] = toValue(entry.second);
      } catch (const std::runtime_error& error) {
        throw std::runtime_error("parameter " + name + ": " + error.what());
      }
    }
  } catch (const std::exception& error) {
    throw std::runtime_error(path + ": " + error.what());
  }
  return values;
}

XmlRpc::XmlRpcValue parseYamlValue(const std::string& text) {
  try {
    return toValue(YAML::Load(text));
  } catch (const std::exception& error) {
    throw std::runtime_error("'" + text + "': " + error.what());
  }
}

}  // namespace adaptive_grid_stereo
