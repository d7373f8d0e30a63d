#ifndef ADAPTIVE_GRID_STEREO_TOOLS_BAG_TOPICS_H
#define ADAPTIVE_GRID_STEREO_TOOLS_BAG_TOPICS_H

#include <optional>
#include <string>
#include <vector>

#include <boost/program_options.hpp>

#include "bag_reader.h"

namespace adaptive_grid_stereo {

/// Names of the topics that carry motion; "" = none.
struct MotionTopics {
  std::string imu, odom, gps_vel, gps_fix, mag;
};

/// Names of the topics to use; "" = none.
struct BagTopics {
  std::string left_image;
  std::string right_image;
  std::string left_info;
  std::string right_info;
  MotionTopics motion;
};

/// The same as the user names them; what he leaves open is found by type and name.
struct NamedTopics {
  std::optional<std::string> left_image, right_image, left_info, right_info;
  std::optional<std::string> imu, odom, gps_vel, gps_fix, mag;
};

/// Options --left-image, --right-image, --left-info, --right-info, and --imu, --odom, --gps-vel,
/// --gps-fix, --mag, the same ones in every tool. Those that name a source of motion take '' or
/// none for no topic; with -topic behind it, as in --imu-topic, each is understood, too. `topics`
/// must outlive the parsing.
boost::program_options::options_description imageTopicOptions(NamedTopics* topics);
boost::program_options::options_description motionTopicOptions(NamedTopics* topics);

/// Finds the stereo pair (two image topics whose names differ only as left and right do, rectified
/// ones first) and its camera_infos; `motion` stays empty. Throws std::runtime_error, listing the
/// candidates, if no pair or several are found, or a named topic is not in the bag or of another
/// type; where images are compressed, it says how to make raw ones of them.
BagTopics chooseImageTopics(const std::vector<BagConnection>& connections,
                            const NamedTopics& named);

/// Finds the motion sources, the same ones for every tool: the only topic of the type, or the one
/// that the flight stacks offer as the better (an Imu with orientation before a raw one, odometry
/// of the body before that of the GPS), or the one with the usual name. What is commanded, and what
/// only a simulation knows, is taken only where it is named; so is a velocity in body axes. Sources
/// that stay in doubt are left out, with a sentence in `notes`. Throws std::runtime_error if a
/// named topic is not in the bag or of another type.
MotionTopics chooseMotionTopics(const std::vector<BagConnection>& connections,
                                const NamedTopics& named, std::vector<std::string>* notes);

/// Both.
BagTopics chooseTopics(const std::vector<BagConnection>& connections, const NamedTopics& named,
                       std::vector<std::string>* notes);

/// The topics of compressed images and how to make raw ones of them, in a sentence; "" if there are
/// none.
std::string compressedImages(const std::vector<BagConnection>& connections);

/// The name space in which the outputs go: what left_image has before "left", e.g. "/stereo".
std::string outputNamespace(const std::string& left_image);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_TOOLS_BAG_TOPICS_H
