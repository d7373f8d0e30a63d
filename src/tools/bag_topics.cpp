#include "bag_topics.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <set>
#include <stdexcept>

namespace adaptive_grid_stereo {
namespace {

namespace po = boost::program_options;

using TypeOf = std::map<std::string, std::string>;  // topic -> type

const char kImage[] = "sensor_msgs/Image";
const char kCompressed[] = "sensor_msgs/CompressedImage";
const char kInfo[] = "sensor_msgs/CameraInfo";

/// How left and right cameras are called.
constexpr std::array<std::array<const char*, 2>, 4> kSides{
    {{{"left", "right"}}, {{"Left", "Right"}}, {{"cam0", "cam1"}}, {{"camera0", "camera1"}}}};

bool endsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

/// The right camera's name of a left camera's topic; "" if it is not one.
std::string rightOf(const std::string& topic) {
  for (const auto& side : kSides) {
    const std::size_t at = topic.find(side[0]);
    if (at == std::string::npos) continue;
    std::string right = topic;
    return right.replace(at, std::string(side[0]).size(), side[1]);
  }
  return "";
}

/// Rectified grey before rectified colour before raw before anything else.
int rankOf(const std::string& topic) {
  if (endsWith(topic, "image_rect")) return 0;
  if (topic.find("image_rect") != std::string::npos) return 1;
  if (endsWith(topic, "image_mono")) return 2;
  if (endsWith(topic, "image_raw")) return 3;
  return 4;
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? "none" : text;
}

std::vector<std::string> topicsOfType(const TypeOf& types, const std::string& type) {
  std::vector<std::string> topics;
  for (const auto& [topic, its_type] : types) {
    if (its_type == type) topics.push_back(topic);
  }
  return topics;
}

/// As compressedImages().
std::string compressedCure(const TypeOf& types) {
  const std::vector<std::string> topics = topicsOfType(types, kCompressed);
  if (topics.empty()) return "";
  // image_transport appends the last part itself.
  const std::string& first = topics.front();
  const std::string base = first.substr(0, first.rfind('/'));
  const std::string transport = first.substr(first.rfind('/') + 1);
  return "images of type " + std::string(kCompressed) + " are: " + listed(topics) +
         "; make raw ones of them: play the bag, run for each 'rosrun image_transport republish " +
         transport + " in:=" + base + " raw out:=" + base +
         "', and record the result with 'rosbag record --all'";
}

void requireType(const TypeOf& types, const std::string& topic, const std::string& type) {
  const auto found = types.find(topic);
  if (found == types.end()) {
    throw std::runtime_error("topic " + topic + " is not in the bag; of type " + type +
                             " are: " + listed(topicsOfType(types, type)));
  }
  if (found->second != type) {
    throw std::runtime_error(
        "topic " + topic + " is of type " + found->second + ", expected " + type +
        (found->second == kCompressed && type == kImage ? "; " + compressedCure(types) : ""));
  }
}

void findImages(const TypeOf& types, const NamedTopics& named, BagTopics* topics) {
  if (named.left_image) {
    topics->left_image = *named.left_image;
    topics->right_image = named.right_image.value_or(rightOf(*named.left_image));
  } else {
    std::vector<std::string> best;
    int best_rank = 100;
    for (const std::string& topic : topicsOfType(types, kImage)) {
      const std::string right = named.right_image.value_or(rightOf(topic));
      const auto found = types.find(right);
      if (rightOf(topic) != right || found == types.end() || found->second != kImage) continue;
      if (rankOf(topic) < best_rank) best.clear();
      best_rank = std::min(best_rank, rankOf(topic));
      if (rankOf(topic) == best_rank) best.push_back(topic);
    }
    if (best.empty() && !compressedCure(types).empty()) {
      throw std::runtime_error("no stereo pair was found by name; topics of type " +
                               std::string(kImage) + ": " + listed(topicsOfType(types, kImage)) +
                               "; " + compressedCure(types));
    }
    if (best.size() != 1) {
      throw std::runtime_error(
          (best.empty() ? "no stereo pair was found by name; topics of type sensor_msgs/Image: " +
                              listed(topicsOfType(types, kImage))
                        : "several stereo pairs were found: " + listed(best)) +
          "; name the topics by --left-image and --right-image");
    }
    topics->left_image = best.front();
    topics->right_image = rightOf(best.front());
  }
  requireType(types, topics->left_image, kImage);
  requireType(types, topics->right_image, kImage);
}

/// camera_info beside the image, or below it (as AirSim has it).
std::string findInfo(const TypeOf& types, const std::optional<std::string>& named,
                     const std::string& image, const std::string& option) {
  if (named) {
    requireType(types, *named, kInfo);
    return *named;
  }
  const std::string beside = image.substr(0, image.rfind('/') + 1) + "camera_info";
  for (const std::string& topic : {beside, image + "/camera_info"}) {
    const auto found = types.find(topic);
    if (found != types.end() && found->second == kInfo) return topic;
  }
  throw std::runtime_error("no camera_info beside " + image + "; name it by " + option +
                           "; topics of type " + kInfo + ": " + listed(topicsOfType(types, kInfo)));
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// Whether a topic can be a sensor's: what the aircraft is told to do, and what only a simulation
/// knows, come in the same types.
bool isMeasured(const std::string& topic) {
  std::string name = topic;
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char letter) { return std::tolower(letter); });
  for (const char* part : {"setpoint", "cmd_vel", "command", "desired", "target", "reference",
                           "ground_truth", "groundtruth"}) {
    if (contains(name, part)) return false;
  }
  return true;
}

/// How much a topic is to be preferred among those of its type.
int preference(const std::string& topic) {
  if (contains(topic, "local_position/odom")) return 2;     // mavros: body axes throughout
  if (contains(topic, "global_position/local")) return -2;  // mavros: vertical sign is wrong
  if (contains(topic, "velocity_local")) return -2;         // mavros: frame is wrong
  if (contains(topic, "raw/gps_vel") || contains(topic, "raw/fix")) return 1;
  if (contains(topic, "data_raw") || contains(topic, "imu/raw")) return -1;  // no orientation
  return 0;
}

/// The measured topics of a type; of these only the most preferred.
std::vector<std::string> motionCandidates(const TypeOf& types, const std::string& type) {
  std::vector<std::string> best;
  for (const std::string& topic : topicsOfType(types, type)) {
    // mavros' velocity_body is of the body, while gps/vel is of the earth unless declared
    // otherwise.
    if (!isMeasured(topic) || contains(topic, "velocity_body")) continue;
    if (!best.empty() && preference(topic) > preference(best.front())) best.clear();
    if (best.empty() || preference(topic) == preference(best.front())) best.push_back(topic);
  }
  return best;
}

std::string findMotion(const TypeOf& types, const std::optional<std::string>& named,
                       const std::string& type, const std::string& option,
                       const std::vector<std::string>& usual_ends,
                       std::vector<std::string>* notes) {
  if (named) {
    if (!named->empty()) requireType(types, *named, type);
    return *named;
  }
  const std::vector<std::string> candidates = motionCandidates(types, type);
  if (candidates.size() == 1) return candidates.front();
  for (const std::string& end : usual_ends) {
    std::vector<std::string> fitting;
    for (const std::string& topic : candidates) {
      if (endsWith(topic, end)) fitting.push_back(topic);
    }
    if (fitting.size() == 1) return fitting.front();
  }
  if (!candidates.empty()) {
    notes->push_back("which of these is meant is not clear, so none is used: " +
                     listed(candidates) + "; name one by " + option);
  }
  return "";
}

TypeOf typesOf(const std::vector<BagConnection>& connections) {
  TypeOf types;
  for (const BagConnection& connection : connections) {
    types[connection.topic] = connection.datatype;
  }
  return types;
}

void addTopicOption(const std::string& name, const char* help, std::optional<std::string>* target,
                    po::options_description* options) {
  // The second name is understood, but not shown.
  const std::string names = name + "," + name + "-topic";
  const auto store = [target](const std::string& topic) { *target = topic == "none" ? "" : topic; };
  options->add_options()(names.c_str(),
                         po::value<std::string>()->value_name("TOPIC")->notifier(store), help);
}

}  // namespace

po::options_description imageTopicOptions(NamedTopics* topics) {
  po::options_description options("image topics (found by name if not given)");
  addTopicOption("left-image", "left images, rectified or raw", &topics->left_image, &options);
  addTopicOption("right-image", "right images", &topics->right_image, &options);
  addTopicOption("left-info", "left camera_info", &topics->left_info, &options);
  addTopicOption("right-info", "right camera_info", &topics->right_info, &options);
  return options;
}

po::options_description motionTopicOptions(NamedTopics* topics) {
  po::options_description options(
      "motion topics (found by type and name if not given; none or '' for none)");
  addTopicOption("imu", "sensor_msgs/Imu", &topics->imu, &options);
  addTopicOption("odom", "nav_msgs/Odometry", &topics->odom, &options);
  addTopicOption("gps-vel", "geometry_msgs/TwistStamped", &topics->gps_vel, &options);
  addTopicOption("gps-fix", "sensor_msgs/NavSatFix", &topics->gps_fix, &options);
  addTopicOption("mag", "sensor_msgs/MagneticField", &topics->mag, &options);
  return options;
}

BagTopics chooseImageTopics(const std::vector<BagConnection>& connections,
                            const NamedTopics& named) {
  const TypeOf types = typesOf(connections);
  BagTopics topics;
  findImages(types, named, &topics);
  topics.left_info = findInfo(types, named.left_info, topics.left_image, "--left-info");
  topics.right_info = findInfo(types, named.right_info, topics.right_image, "--right-info");
  return topics;
}

MotionTopics chooseMotionTopics(const std::vector<BagConnection>& connections,
                                const NamedTopics& named, std::vector<std::string>* notes) {
  const TypeOf types = typesOf(connections);
  MotionTopics topics;
  topics.imu = findMotion(types, named.imu, "sensor_msgs/Imu", "--imu",
                          {"imu/data", "/imu", "imu/data_raw"}, notes);
  topics.odom = findMotion(types, named.odom, "nav_msgs/Odometry", "--odom",
                           {"local_position/odom", "/odom", "odometry"}, notes);
  topics.gps_vel = findMotion(types, named.gps_vel, "geometry_msgs/TwistStamped", "--gps-vel",
                              {"gps/vel", "gps_vel", "velocity_local"}, notes);
  topics.gps_fix = findMotion(types, named.gps_fix, "sensor_msgs/NavSatFix", "--gps-fix",
                              {"gps/fix", "raw/fix", "/fix", "global"}, notes);
  topics.mag = findMotion(types, named.mag, "sensor_msgs/MagneticField", "--mag",
                          {"imu/mag", "/mag"}, notes);
  return topics;
}

BagTopics chooseTopics(const std::vector<BagConnection>& connections, const NamedTopics& named,
                       std::vector<std::string>* notes) {
  BagTopics topics = chooseImageTopics(connections, named);
  topics.motion = chooseMotionTopics(connections, named, notes);
  return topics;
}

std::string compressedImages(const std::vector<BagConnection>& connections) {
  return compressedCure(typesOf(connections));
}

std::string outputNamespace(const std::string& left_image) {
  for (const auto& side : kSides) {
    const std::size_t at = left_image.find(side[0]);
    if (at == std::string::npos) continue;
    const std::size_t slash = left_image.rfind('/', at);
    return slash == std::string::npos ? "" : left_image.substr(0, slash);
  }
  const std::size_t slash = left_image.rfind('/');
  return slash == std::string::npos ? "" : left_image.substr(0, slash);
}

}  // namespace adaptive_grid_stereo
