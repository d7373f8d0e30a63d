#include "bag_processor.h"

#include <algorithm>
#include <deque>
#include <ostream>

#include "adaptive_grid_stereo/ros/input_check.h"
#include "adaptive_grid_stereo/ros/motion_subscriber.h"
#include "adaptive_grid_stereo/ros/stamps.h"
#include "adaptive_grid_stereo/ros/stereo_pairing.h"
#include "grid_state_csv.h"
#include "raw_message.h"
#include "rectifier.h"

namespace adaptive_grid_stereo {
namespace {

/// A pair waits until the recording has gone on for so long after it [s]: by then all motion
/// samples that count for its stamp have been read.
constexpr double kLookAhead = 1.0;

class BagProcessor {
 public:
  BagProcessor(BagReader* input, const BagJob& job, rosbag::Bag* output, std::ostream* csv)
      : input_(*input),
        job_(job),
        output_(*output),
        csv_(csv),
        motion_(job.config.motion),
        processor_(job.config.processor),
        pairs_(
            pairingOptions(job.config), [this](const ReceivedPair& p) { pending_.push_back(p); },
            [this](const ros::Time& stamp) { onJump(stamp); }) {
    limits_.baseline = job.config.baseline;
    if (job.config.approximate_sync) {
      limits_.max_stamp_difference = job.config.approximate_sync_max_interval;
    }
    names_ = {job.topics.left_image, job.topics.right_image, job.topics.left_info,
              job.topics.right_info};
  }

  BagReport run(const std::function<void(long)>& progress) {
    readStaticTransforms();
    if (csv_) *csv_ << gridStateCsvHeader();
    input_.rewind();
    BagMessage message;
    while (input_.next(&message)) {
      // Pairs first, so that the reading of a whole bag stays in the order of recording.
      processUntil(message.time);
      copyThrough(message);
      try {
        take(message);
      } catch (const std::exception& error) {
        ++report_.damaged;
        ++report_.reasons[error.what()];
      }
      progress(report_.left_images);
    }
    processAll();
    return report_;
  }

 private:
  static PairingOptions pairingOptions(const NodeConfig& config) {
    PairingOptions options;
    options.approximate = config.approximate_sync;
    options.max_interval = config.approximate_sync_max_interval;
    // As the nodelet does where every frame counts.
    options.queue_size = std::max(config.queue_size, 100);
    return options;
  }

  /// They may be recorded late, while live they are latched.
  void readStaticTransforms() {
    input_.rewind();
    BagMessage message;
    while (input_.next(&message)) {
      const std::string& topic = message.connection->topic;
      if (topic != "/tf_static" && topic != "tf_static") continue;
      try {
        motion_.add(*deserialize<tf2_msgs::TFMessage>(message), true);
      } catch (const std::exception& error) {
        ++report_.damaged;
        ++report_.reasons[error.what()];
      }
    }
  }

  void take(const BagMessage& message) {
    const std::string& topic = message.connection->topic;
    const BagTopics& t = job_.topics;
    const MotionTopics& m = t.motion;
    if (topic == t.left_image) {
      ++report_.left_images;
      pairs_.addLeft(deserialize<sensor_msgs::Image>(message), message.time);
    } else if (topic == t.right_image) {
      pairs_.addRight(deserialize<sensor_msgs::Image>(message), message.time);
    }
    // One camera_info may serve both sides of a badly recorded rig; checkPair() will complain.
    if (topic == t.left_info) {
      pairs_.addLeftInfo(deserialize<sensor_msgs::CameraInfo>(message), message.time);
    }
    if (topic == t.right_info) {
      pairs_.addRightInfo(deserialize<sensor_msgs::CameraInfo>(message), message.time);
    }
    if (topic == m.imu) motion_.add(*deserialize<sensor_msgs::Imu>(message));
    if (topic == m.odom) motion_.add(*deserialize<nav_msgs::Odometry>(message));
    if (topic == m.gps_vel) motion_.add(*deserialize<geometry_msgs::TwistStamped>(message));
    if (topic == m.gps_fix) motion_.add(*deserialize<sensor_msgs::NavSatFix>(message));
    if (topic == m.mag) motion_.add(*deserialize<sensor_msgs::MagneticField>(message));
    if (topic == "/tf" || topic == "tf") {
      motion_.add(*deserialize<tf2_msgs::TFMessage>(message), false);
    }
  }

  void copyThrough(const BagMessage& message) {
    const BagConnection& connection = *message.connection;
    if (!job_.pass_through || !job_.pass_through(connection.topic)) return;
    output_.write(connection.topic, message.time, RawMessage{&message}, connection.header);
  }

  void onJump(const ros::Time& stamp) {
    processAll();
    motion_.startOver(stamp);
    processor_.reset();
  }

  /// Pairs that have waited long enough by the time at which the recording has arrived.
  void processUntil(const ros::Time& now) {
    while (!pending_.empty() && secondsBetween(pending_.front().received, now) >= kLookAhead) {
      processNext();
    }
  }

  void processAll() {
    while (!pending_.empty()) processNext();
  }

  void processNext() {
    const ReceivedPair pair = pending_.front();
    pending_.pop_front();
    std::string fault;
    try {
      fault = process(pair);
    } catch (const rosbag::BagException&) {
      throw;  // the output, not the pair
    } catch (const std::exception& error) {
      fault = std::string("a pair could not be processed: ") + error.what();
    }
    if (fault.empty()) return;
    ++report_.refused;
    ++report_.reasons[fault];
  }

  /// Why the pair was refused; empty if it was not.
  std::string process(const ReceivedPair& recorded) {
    StereoPair pair = recorded.pair;
    rectify(&pair);
    const InputVerdict verdict = checkPair(pair, limits_, names_);
    if (!verdict.ok()) return verdict.error;
    const std_msgs::Header& header = pair.left->header;
    const Motion motion = motion_.motionAt(header.stamp, header.frame_id);
    const FrameResult frame = processor_.process(pair, verdict.geometry, motion);
    if (!job_.timing) frame.grid_state->processing_time = 0.0;
    frame.grid_state->latency = 0.0;
    frame.grid_state->frames_dropped =
        static_cast<std::uint32_t>(report_.refused + pairs_.dropped());
    write("disparity", recorded.received, *frame.disparity);
    write("grid_state", recorded.received, *frame.grid_state);
    const SideOutputs side = processor_.makeSideOutputs(frame, job_.wanted);
    if (side.depth) write("depth", recorded.received, *side.depth);
    if (side.overlay) write("grid_overlay", recorded.received, *side.overlay);
    if (side.disparity_color) write("disparity_color", recorded.received, *side.disparity_color);
    if (csv_) *csv_ << toCsvLine(*frame.grid_state);
    ++report_.frames;
    ++report_.states[toString(frame.state)];
    if (!motion.valid) {
      ++report_.motion_unknown;
      report_.motion_reason = motion.reason;
    }
    return "";
  }

  void rectify(StereoPair* pair) {
    if (job_.rectify == RectifyMode::kNo) return;
    const bool always = job_.rectify == RectifyMode::kYes;
    if (always || needsRectification(job_.topics.left_image, *pair->left_info)) {
      pair->left = left_rectifier_.rectify(pair->left, *pair->left_info);
    }
    if (always || needsRectification(job_.topics.right_image, *pair->right_info)) {
      pair->right = right_rectifier_.rectify(pair->right, *pair->right_info);
    }
  }

  template <typename Message>
  void write(const std::string& name, const ros::Time& time, const Message& message) {
    // rosbag refuses the zero time.
    output_.write(job_.output_namespace + "/" + name, std::max(time, ros::TIME_MIN), message);
  }

  BagReader& input_;
  const BagJob& job_;
  rosbag::Bag& output_;
  std::ostream* csv_;
  MotionSubscriber motion_;
  FrameProcessor processor_;
  StereoPairing pairs_;
  Rectifier left_rectifier_;
  Rectifier right_rectifier_;
  InputLimits limits_;
  InputTopics names_;
  std::deque<ReceivedPair> pending_;
  BagReport report_;
};

}  // namespace

BagReport processBag(BagReader* input, const BagJob& job, rosbag::Bag* output, std::ostream* csv,
                     const std::function<void(long)>& progress) {
  return BagProcessor(input, job, output, csv).run(progress);
}

}  // namespace adaptive_grid_stereo
