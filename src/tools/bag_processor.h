#ifndef ADAPTIVE_GRID_STEREO_TOOLS_BAG_PROCESSOR_H
#define ADAPTIVE_GRID_STEREO_TOOLS_BAG_PROCESSOR_H

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <rosbag/bag.h>

#include "adaptive_grid_stereo/ros/parameters.h"
#include "bag_reader.h"
#include "bag_topics.h"

namespace adaptive_grid_stereo {

/// Rectification of the images: by name and calibration, always, never.
enum class RectifyMode { kAuto, kYes, kNo };

struct BagJob {
  NodeConfig config;
  BagTopics topics;
  std::string output_namespace;  // e.g. "/stereo": outputs are /stereo/disparity, ...
  RectifyMode rectify = RectifyMode::kAuto;
  WantedOutputs wanted;
  /// Topics for which this is true are copied as they are; empty: none.
  std::function<bool(const std::string&)> pass_through;
  /// Write how long each frame took; two runs then differ.
  bool timing = false;
};

/// What came of a bag.
struct BagReport {
  long left_images = 0;
  long frames = 0;                      // processed
  long refused = 0;                     // pairs that could not be processed
  long damaged = 0;                     // messages that could not be read
  std::map<std::string, long> reasons;  // sentences, and how often
  std::map<std::string, long> states;   // frames per state
  long motion_unknown = 0;              // frames without motion
  std::string motion_reason;            // the last reason for that
};

/// Runs every pair of `input` in order through the same pairing, motion and frame processor as the
/// nodelet's, writes the results into `output` with the left image's stamp and recording time, and
/// one line per frame into `csv` where it is not null. `progress` gets the left images read so far.
/// The same bag and job give the same bytes. Throws std::exception if the output cannot be written.
BagReport processBag(BagReader* input, const BagJob& job, rosbag::Bag* output, std::ostream* csv,
                     const std::function<void(long)>& progress);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_TOOLS_BAG_PROCESSOR_H
