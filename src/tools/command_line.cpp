#include "command_line.h"

#include <algorithm>
#include <array>
#include <exception>
#include <filesystem>
#include <iostream>
#include <sstream>

#include <opencv2/core/utils/logger.hpp>

namespace po = boost::program_options;

namespace adaptive_grid_stereo {
namespace {

void printHelp(const ToolHelp& help, const po::options_description& options) {
  std::cout << "usage: " << help.name << ' ' << help.arguments << "\n\n"
            << help.purpose << "\n\n"
            << options;
  if (!help.examples.empty()) std::cout << "\nexamples:\n" << help.examples;
}

}  // namespace

bool parseCommandLine(int argc, const char* const* argv, const ToolHelp& help,
                      const po::options_description& options,
                      const std::vector<std::string>& positional, po::variables_map* values) {
  po::options_description all = options;
  all.add_options()("help,h", "show this help")("version", "show the version");
  po::positional_options_description positions;
  for (std::size_t i = 0; i < positional.size(); ++i) {
    // The last one takes all that follow only if its name says so.
    const bool many = positional[i].back() == '*';
    const std::string name =
        many ? positional[i].substr(0, positional[i].size() - 1) : positional[i];
    all.add_options()(name.c_str(),
                      many ? static_cast<po::value_semantic*>(po::value<std::vector<std::string>>())
                           : po::value<std::string>());
    positions.add(name.c_str(), many ? -1 : 1);
  }
  try {
    const int style = po::command_line_style::unix_style & ~po::command_line_style::allow_guessing;
    po::store(
        po::command_line_parser(argc, argv).options(all).positional(positions).style(style).run(),
        *values);
    if (values->count("help") > 0) {
      printHelp(help, options);
      return false;
    }
    if (values->count("version") > 0) {
      std::cout << help.name << " (adaptive_grid_stereo) " << AGS_VERSION << '\n';
      return false;
    }
    po::notify(*values);
  } catch (const po::error& error) {
    throw UsageError(std::string(error.what()) + "; see " + help.name + " --help");
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
  return true;
}

void checkDistinct(std::vector<std::string> paths) {
  for (std::string& path : paths) {
    path = std::filesystem::path(path).lexically_normal().string();
    if (path.rfind("/dev/", 0) == 0) path.clear();
  }
  std::sort(paths.begin(), paths.end());
  const auto same =
      std::adjacent_find(paths.begin(), paths.end(),
                         [](const auto& a, const auto& b) { return !a.empty() && a == b; });
  if (same != paths.end()) throw UsageError(*same + " is to be written twice: give two names");
}

void reportCorrections(const std::string& tool, const std::vector<std::string>& sentences) {
  for (const std::string& sentence : sentences) std::cerr << tool << ": " << sentence << '\n';
}

int runTool(const std::string& tool, const std::function<int()>& body) {
  // OpenCV would add its own lines about files that the tools complain about in words.
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  try {
    return body();
  } catch (const UsageError& error) {
    std::cerr << tool << ": " << error.what() << '\n';
    return 2;
  } catch (const std::exception& error) {
    std::cerr << tool << ": " << error.what() << '\n';
    return 1;
  } catch (...) {
    std::cerr << tool << ": failed for an unknown reason\n";
    return 1;
  }
}

}  // namespace adaptive_grid_stereo
