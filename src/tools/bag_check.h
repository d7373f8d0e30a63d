#ifndef ADAPTIVE_GRID_STEREO_TOOLS_BAG_CHECK_H
#define ADAPTIVE_GRID_STEREO_TOOLS_BAG_CHECK_H

#include <string>
#include <vector>

#include "adaptive_grid_stereo/guidance/motion_config.h"
#include "bag_reader.h"
#include "bag_topics.h"
#include "motion_log.h"

namespace adaptive_grid_stereo {

enum class Verdict { kOk, kWarning, kError };

/// One thing that was looked at.
struct Finding {
  Verdict verdict = Verdict::kOk;
  std::string subject;  // e.g. "stereo stamps"
  std::string text;     // what was found and, unless it is good, the cure
};

/// Pairs and their stamps, gaps, encodings, sizes, calibration, baseline. baseline [m]: the node's
/// parameter, 0: by camera_info. Throws std::runtime_error if a message is damaged.
std::vector<Finding> checkImages(BagReader* bag, const NamedTopics& named, double baseline);

/// Presence, rates, gaps and stamps of the motion sources; axes that contradict each other: gravity
/// against the up axis, the orientation's turn against the rates, course against heading, the
/// course's turn against the rates, odometry against GPS. Damaged messages are counted.
std::vector<Finding> checkMotion(BagReader* bag, const MotionTopics& topics,
                                 const MotionConfig& config, const std::string& optical_frame);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_TOOLS_BAG_CHECK_H
