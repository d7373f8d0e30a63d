#ifndef ADAPTIVE_GRID_STEREO_TOOLS_COMMAND_LINE_H
#define ADAPTIVE_GRID_STEREO_TOOLS_COMMAND_LINE_H

#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include <boost/program_options.hpp>

#include "adaptive_grid_stereo/guidance/guidance_config.h"
#include "adaptive_grid_stereo/matching/matcher_config.h"

namespace adaptive_grid_stereo {

/// A mistake in how a tool was called: message on stderr, exit code 2.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One option per parameter of the struct: the ROS parameter's name with dashes for underscores
/// (disp12MaxDiff is accepted as it is, too). The defaults are the struct's own values. `config`
/// must outlive the parsing.
boost::program_options::options_description matcherOptions(MatcherConfig* config);
boost::program_options::options_description guidanceOptions(GuidanceConfig* config);

/// The option of a ROS parameter: "disparity_range" -> "disparity-range", "disp12MaxDiff" ->
/// "disp12-max-diff".
std::string optionName(const std::string& parameter);

/// What a parameter does, with its unit, for `--help`; "" if it is unknown.
std::string parameterHelp(const std::string& parameter);

/// What one tool says about itself.
struct ToolHelp {
  std::string name;
  std::string arguments;  // e.g. "LEFT RIGHT --output D.pfm [options]"
  std::string purpose;    // a sentence or two
  std::string examples;   // may be empty
};

/// Parses the command line into the variables that `options` and `positional` name; `--help` and
/// `--version` are added. Returns false if one of them was asked for and answered on stdout.
/// Throws UsageError. Abbreviated option names are refused, since new options would change what
/// they mean.
bool parseCommandLine(int argc, const char* const* argv, const ToolHelp& help,
                      const boost::program_options::options_description& options,
                      const std::vector<std::string>& positional,
                      boost::program_options::variables_map* values);

/// Throws UsageError if two files to write are the same one; devices and empty names do not count.
void checkDistinct(std::vector<std::string> paths);

/// Prints every sentence of a config's validate() on stderr.
void reportCorrections(const std::string& tool, const std::vector<std::string>& sentences);

/// Runs a tool's body and turns whatever it throws into "<tool>: message" on stderr; exit codes:
/// 0 done, 1 failed, 2 called wrongly.
int runTool(const std::string& tool, const std::function<int()>& body);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_TOOLS_COMMAND_LINE_H
