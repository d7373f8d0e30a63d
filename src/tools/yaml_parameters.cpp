#include "yaml_parameters.h"

#include <cmath>
#include <optional>
#include <sstream>
#include <stdexcept>

#include <yaml-cpp/yaml.h>

#include "command_line.h"

namespace adaptive_grid_stereo {
namespace {

/// The value of e.g. "-0.5", "pi / 2" or "3*pi/4"; NaN for other text.
double product(const std::string& text) {
  std::istringstream stream(text);
  double result = 1.0;
  for (char operation = '*'; operation == '*' || operation == '/';) {
    double factor = 1.0;
    if ((stream >> std::ws).peek() == '-') {
      stream.get();
      factor = -1.0;
    }
    if ((stream >> std::ws).peek() == 'p') {
      stream.get();
      if (stream.get() != 'i') break;
      factor *= M_PI;
    } else {
      double number = 0.0;
      if (!(stream >> number)) break;
      factor *= number;
    }
    result = operation == '*' ? result * factor : result / factor;
    if (!(stream >> operation)) return result;
  }
  return std::nan("");
}

/// The angle [rad] of deg(...) or rad(...), which rosparam understands; nothing for other text.
std::optional<double> angleOf(const std::string& text) {
  const std::string unit = text.substr(0, 4);
  if ((unit != "deg(" && unit != "rad(") || text.back() != ')') return std::nullopt;
  const double value = product(text.substr(4, text.size() - 5));
  if (!std::isfinite(value)) {
    throw std::runtime_error(text + " is no angle; expected e.g. deg(3.5), rad(0.06) or rad(pi/2)");
  }
  return unit == "deg(" ? value * M_PI / 180.0 : value;
}

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
  if (const std::optional<double> angle = angleOf(node.Scalar())) {
    return XmlRpc::XmlRpcValue(*angle);
  }
  return XmlRpc::XmlRpcValue(node.Scalar());
}

bool isNumber(const XmlRpc::XmlRpcValue& value) {
  return value.getType() == XmlRpc::XmlRpcValue::TypeInt ||
         value.getType() == XmlRpc::XmlRpcValue::TypeDouble;
}

/// Whether a text is a list of numbers that lacks its brackets.
bool isBareList(const std::string& text) {
  if (text.find(',') == std::string::npos || text.find_first_of("[]{}'\"#") != std::string::npos) {
    return false;
  }
  XmlRpc::XmlRpcValue list = toValue(YAML::Load("[" + text + "]"));
  for (int i = 0; i < list.size(); ++i) {
    if (!isNumber(list[i])) return false;
  }
  return true;
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
    return toValue(YAML::Load(isBareList(text) ? "[" + text + "]" : text));
  } catch (const std::exception& error) {
    throw std::runtime_error("'" + text + "': " + error.what());
  }
}

XmlRpc::XmlRpcValue parseParameterOption(const std::string& parameter, const std::string& text) {
  const std::string option = "--" + optionName(parameter) + " ";
  XmlRpc::XmlRpcValue value;
  try {
    value = parseYamlValue(text);
  } catch (const std::runtime_error& error) {
    throw UsageError(option + error.what());
  }
  const std::string expected = expectedInstead(parameter, value);
  if (!expected.empty()) throw UsageError(option + "'" + text + "': expected " + expected);
  return value;
}

}  // namespace adaptive_grid_stereo
