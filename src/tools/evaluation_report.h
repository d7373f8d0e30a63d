#ifndef ADAPTIVE_GRID_STEREO_TOOLS_EVALUATION_REPORT_H
#define ADAPTIVE_GRID_STEREO_TOOLS_EVALUATION_REPORT_H

#include <string>
#include <vector>

#include "evaluation_summary.h"

namespace adaptive_grid_stereo {

/// What the figures were measured with.
struct EvaluationSetting {
  std::string command;
  int threads = 0;
  int repeat = 0;
};

/// A line per method. Times are also given as shares of the peers' (as they are, not padded).
std::string methodTable(const std::vector<MethodSummary>& methods);

/// What the columns of methodTable() mean.
std::string tableLegend();

/// A line per scene, method and region (visible, all, and the same in the focus), for a
/// spreadsheet; ratios to every peer, padded ones too.
std::string toCsv(const std::vector<SceneSummary>& scenes);

/// Everything, the means over the families included.
std::string toJson(const std::vector<SceneSummary>& scenes, const EvaluationSetting& setting);

/// Left image and truth above disparity and error of: uniform 16, the adaptive plan with the fewest
/// paths, and the best peer, as far as they ran. BGR.
cv::Mat scenePicture(const SceneResult& result);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_TOOLS_EVALUATION_REPORT_H
