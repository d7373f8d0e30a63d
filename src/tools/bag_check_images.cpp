#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "adaptive_grid_stereo/ros/input_check.h"
#include "adaptive_grid_stereo/ros/stamps.h"
#include "bag_check.h"
#include "rectifier.h"
#include "text_table.h"
#include "threshold_tuning.h"

namespace adaptive_grid_stereo {

namespace {

/// Images further apart than this belong to no common pair [s].
constexpr double kPairLimit = 0.1;
/// The largest difference that approximate_sync accepts by default [s].
constexpr double kDefaultInterval = 0.02;

/// The stereo messages of a bag; of the images only two are kept whole.
struct StereoContents {
  std::vector<double> left, right;                 // stamps [s]
  std::map<double, double> left_info, right_info;  // stamps
  std::vector<double> delays;                      // recorded after stamped [s], left
  StereoPair sample;  // the images nearest in time, and the first of each camera_info
};

/// The right image's stamp next to a left one's; the right images are not empty.
double nearestRight(const StereoContents& contents, double stamp) {
  const auto next = std::lower_bound(contents.right.begin(), contents.right.end(), stamp);
  if (next == contents.right.begin()) return *next;
  if (next == contents.right.end() || stamp - *(next - 1) < *next - stamp) return *(next - 1);
  return *next;
}

/// Keeps the first of the pairs whose stamps differ the least: the first two images alone need not
/// belong together, since recordings begin and end anywhere.
void keepNearestPair(BagReader* bag, const BagTopics& topics, StereoContents* contents) {
  if (contents->left.empty() || contents->right.empty()) return;
  const auto difference = [&](double stamp) {
    return std::abs(nearestRight(*contents, stamp) - stamp);
  };
  const double left =
      *std::min_element(contents->left.begin(), contents->left.end(),
                        [&](double a, double b) { return difference(a) < difference(b); });
  const double right = nearestRight(*contents, left);
  StereoPair& sample = contents->sample;
  bag->rewind();
  for (BagMessage message; (!sample.left || !sample.right) && bag->next(&message);) {
    const std::string& topic = message.connection->topic;
    if (topic != topics.left_image && topic != topics.right_image) continue;
    const bool is_left = topic == topics.left_image;
    const auto image = deserialize<sensor_msgs::Image>(message);
    if (image->header.stamp.toSec() == (is_left ? left : right)) {
      (is_left ? sample.left : sample.right) = image;
    }
  }
}

StereoContents readStereo(BagReader* bag, const BagTopics& topics) {
  StereoContents contents;
  const auto stampOf = [](const std_msgs::Header& header) { return header.stamp.toSec(); };
  bag->rewind();
  for (BagMessage message; bag->next(&message);) {
    const std::string& topic = message.connection->topic;
    if (topic == topics.left_image || topic == topics.right_image) {
      const auto image = deserialize<sensor_msgs::Image>(message);
      const bool left = topic == topics.left_image;
      (left ? contents.left : contents.right).push_back(stampOf(image->header));
      if (left) contents.delays.push_back(secondsBetween(image->header.stamp, message.time));
    } else if (topic == topics.left_info || topic == topics.right_info) {
      const auto info = deserialize<sensor_msgs::CameraInfo>(message);
      const bool left = topic == topics.left_info;
      (left ? contents.left_info : contents.right_info)[stampOf(info->header)] = 0.0;
      auto& kept = left ? contents.sample.left_info : contents.sample.right_info;
      if (!kept) kept = info;
    }
  }
  std::sort(contents.left.begin(), contents.left.end());
  std::sort(contents.right.begin(), contents.right.end());
  keepNearestPair(bag, topics, &contents);
  return contents;
}

std::vector<double> intervalsOf(const std::vector<double>& stamps) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < stamps.size(); ++i) intervals.push_back(stamps[i] - stamps[i - 1]);
  return intervals;
}

/// |left - nearest right| for each left image that has one near: what is half a frame away or more
/// belongs to another frame.
std::vector<double> stampDifferences(const StereoContents& contents) {
  std::vector<double> result;
  if (contents.right.empty()) return result;
  const double period = quantile(intervalsOf(contents.left), 0.5);
  const double limit = period > 0.0 ? std::min(kPairLimit, 0.5 * period) : kPairLimit;
  for (const double stamp : contents.left) {
    const double difference = std::abs(nearestRight(contents, stamp) - stamp);
    if (difference <= limit) result.push_back(difference);
  }
  return result;
}

Finding pairsFinding(const StereoContents& contents, const std::vector<double>& differences) {
  Finding finding = {Verdict::kOk, "stereo pairs", ""};
  const auto equal =
      static_cast<std::size_t>(std::count(differences.begin(), differences.end(), 0.0));
  const double largest =
      differences.empty() ? 0.0 : *std::max_element(differences.begin(), differences.end());
  finding.text = std::to_string(contents.left.size()) + " left and " +
                 std::to_string(contents.right.size()) + " right images, " + std::to_string(equal) +
                 " pairs with equal stamps";
  if (differences.empty()) {
    finding.verdict = Verdict::kError;
    finding.text += "; no two are within 0.1 s: are both cameras stamped by one clock?";
  } else if (equal < 0.95 * static_cast<double>(contents.left.size())) {
    finding.text += ", else up to " + fixed(1e3 * largest, 1) + " ms apart";
    if (equal + 1 < differences.size()) {
      finding.verdict = Verdict::kWarning;
      finding.text += ": set approximate_sync";
      if (largest > kDefaultInterval) {
        finding.text +=
            " and approximate_sync_max_interval: " + fixed(std::ceil(1e3 * largest + 1.0) / 1e3, 3);
      }
      finding.text +=
          "; while the aircraft turns, each ms shifts the images against each other (trigger both "
          "cameras together)";
    } else {
      finding.verdict = Verdict::kWarning;
      finding.text += ": images of one side are missing";
    }
  }
  return finding;
}

Finding gapsFinding(const std::vector<double>& stamps) {
  Finding finding = {Verdict::kOk, "image rate", ""};
  const std::vector<double> intervals = intervalsOf(stamps);
  const double period = quantile(intervals, 0.5);
  if (period <= 0.0) {
    finding.verdict = Verdict::kError;
    finding.text = stamps.size() < 2 ? "fewer than two images" : "most images have equal stamps";
    return finding;
  }
  const auto gaps = std::count_if(intervals.begin(), intervals.end(),
                                  [&](double interval) { return interval > 2.5 * period; });
  finding.text =
      fixed(1.0 / period, 1) + " Hz, " + std::to_string(gaps) + " gaps of more than two frames";
  if (gaps > 0) {
    finding.text +=
        ", the longest " + fixed(*std::max_element(intervals.begin(), intervals.end()), 2) + " s";
    finding.verdict = Verdict::kWarning;
  }
  return finding;
}

Finding infoFinding(const StereoContents& contents) {
  const auto missing = [](const std::vector<double>& images,
                          const std::map<double, double>& infos) {
    return std::count_if(images.begin(), images.end(),
                         [&](double stamp) { return infos.count(stamp) == 0; });
  };
  const auto left = missing(contents.left, contents.left_info);
  const auto right = missing(contents.right, contents.right_info);
  if (left == 0 && right == 0) {
    return {Verdict::kOk, "camera_info", "one with the stamp of each image"};
  }
  return {contents.left_info.empty() || contents.right_info.empty() ? Verdict::kError
                                                                    : Verdict::kWarning,
          "camera_info",
          std::to_string(left) + " left and " + std::to_string(right) +
              " images have no camera_info of their stamp; the driver must publish both together"};
}

void calibrationFindings(const StereoPair& sample, const BagTopics& topics, double baseline,
                         std::vector<Finding>* findings) {
  InputLimits limits;
  limits.baseline = baseline;
  const InputVerdict verdict = checkPair(
      sample, limits, {topics.left_image, topics.right_image, topics.left_info, topics.right_info});
  for (const std::string& warning : verdict.warnings) {
    findings->push_back({Verdict::kWarning, "calibration", warning});
  }
  if (!verdict.ok()) {
    findings->push_back({Verdict::kError, "images and calibration", verdict.error});
    return;
  }
  findings->push_back({Verdict::kOk, "images and calibration",
                       std::to_string(sample.left->width) + " x " +
                           std::to_string(sample.left->height) + " " + sample.left->encoding +
                           ", f " + fixed(verdict.geometry.focal_length, 1) + " px, baseline " +
                           fixed(verdict.geometry.baseline, 4) + " m (" +
                           verdict.geometry.baseline_source + ")"});
  for (const auto& [topic, info] : {std::make_pair(topics.left_image, sample.left_info),
                                    std::make_pair(topics.right_image, sample.right_info)}) {
    if (!needsRectification(topic, *info)) continue;
    findings->push_back({Verdict::kWarning, "rectification",
                         topic + " is not rectified, its camera_info holds distortion or a "
                                 "rotation: run image_proc before the node"});
  }
}

}  // namespace

std::vector<Finding> checkImages(BagReader* bag, const NamedTopics& named, double baseline) {
  std::vector<Finding> findings;
  const auto& connections = bag->connections();
  const bool any = std::any_of(connections.begin(), connections.end(), [](const auto& connection) {
    return connection.datatype == "sensor_msgs/Image";
  });
  if (!any) {
    const std::string compressed = compressedImages(connections);
    return {{Verdict::kWarning, "stereo pairs",
             "no sensor_msgs/Image in the bag: the motion alone is checked" +
                 (compressed.empty() ? "" : "; " + compressed)}};
  }
  BagTopics topics;
  try {
    topics = chooseImageTopics(connections, named);
  } catch (const std::runtime_error& error) {
    return {{Verdict::kError, "stereo pairs", error.what()}};
  }
  const StereoContents contents = readStereo(bag, topics);
  findings.push_back(pairsFinding(contents, stampDifferences(contents)));
  findings.push_back(gapsFinding(contents.left));
  findings.push_back(infoFinding(contents));
  const StereoPair& sample = contents.sample;
  if (sample.left && sample.right && sample.left_info && sample.right_info) {
    calibrationFindings(sample, topics, baseline, &findings);
  }
  const double delay = quantile(contents.delays, 0.5);
  if (std::abs(delay) > 1.0) {
    findings.push_back({Verdict::kWarning, "image stamps",
                        "recorded " + fixed(delay, 2) +
                            " s after their stamps: is the camera stamped by another clock?"});
  }
  return findings;
}

}  // namespace adaptive_grid_stereo
