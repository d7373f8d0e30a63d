#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <dynamic_reconfigure/server.h>
#include <image_transport/image_transport.h>
#include <nodelet/nodelet.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <pluginlib/class_list_macros.hpp>

#include "adaptive_grid_stereo/ros/diagnostics.h"
#include "adaptive_grid_stereo/ros/frame_processor.h"
#include "adaptive_grid_stereo/ros/input_check.h"
#include "adaptive_grid_stereo/ros/mailbox.h"
#include "adaptive_grid_stereo/ros/motion_subscriber.h"
#include "adaptive_grid_stereo/ros/parameters.h"
#include "adaptive_grid_stereo/ros/stamps.h"
#include "adaptive_grid_stereo/ros/stereo_sync.h"
#include "outputs.h"
#include "sentence_throttle.h"

namespace adaptive_grid_stereo {

/// Messages that wait where every frame counts: a recording may be played faster than it is
/// matched.
constexpr int kBurst = 100;

/// A callback queue and the thread that serves it. Not the manager's ones: their threads hold the
/// nodelet while they run a callback, so it may end in one of them, after the manager has taken
/// away the queues from which its subscriptions then remove themselves.
class QueueThread {
 public:
  ros::NodeHandle handle(const ros::NodeHandle& like) {
    ros::NodeHandle handle(like);
    handle.setCallbackQueue(&queue_);
    return handle;
  }
  void start() { spinner_.start(); }
  /// No callback runs any more when it has returned. May be called again.
  void stop() { spinner_.stop(); }

 private:
  ros::CallbackQueue queue_;
  ros::AsyncSpinner spinner_{1, &queue_};
};

/// Stereo pairs and motion in, disparity and grid state out.
///
/// Threads: one for images, reconfiguration, connections and timers, and one for motion. A worker
/// thread owns the frame processor; it gets pairs through the mailbox and the configuration by copy
/// at the start of a frame.
class DisparityNodelet : public nodelet::Nodelet {
 public:
  ~DisparityNodelet() override;

 private:
  struct Frame {
    StereoPair pair;
    StereoGeometry geometry;
    int jumps = 0;  // of the stamps, before it
  };
  using FrameMailbox = Mailbox<Frame>;
  using ReconfigureServer = dynamic_reconfigure::Server<DisparityConfig>;

  void onInit() override;
  void setUp();
  // Nothing of ours runs after it has returned. May be called again.
  void shutDown();
  std::string usableTransport(std::vector<std::string>& warnings);
  void setUpSync();
  void setUpReconfigure();
  void reportStart(const std::vector<std::string>& warnings);

  void onConnection();
  void subscribeIfWanted();
  void onPair(const StereoPair& pair);
  void onJump(const ros::Time& stamp);
  void onReconfigure(DisparityConfig& reconfigure);
  void fillReport(NodeReport& report);

  void work();
  void processFrame(const Frame& frame);
  // After the disparity, which does not wait for pictures.
  void publishSideOutputs(const FrameResult& result);

  // Before all that has callbacks in them.
  QueueThread main_thread_, motion_thread_;
  ros::NodeHandle handle_, private_handle_;  // of main_thread_

  NodeConfig config_;  // stays as it is, but its processor part, under config_mutex_
  std::mutex config_mutex_;
  bool config_changed_ = false;  // under config_mutex_

  std::unique_ptr<FrameProcessor> processor_;  // the worker's
  std::unique_ptr<MotionSubscriber> motion_;
  std::unique_ptr<NodeDiagnostics> diagnostics_;
  std::unique_ptr<StereoSync> sync_;
  std::mutex connect_mutex_;    // held while outputs_ is being made
  bool shutting_down_ = false;  // under connect_mutex_
  std::unique_ptr<Outputs> outputs_;
  std::unique_ptr<FrameMailbox> mailbox_;
  boost::recursive_mutex reconfigure_mutex_;
  std::unique_ptr<ReconfigureServer> reconfigure_;
  std::thread worker_;

  bool reconfigured_once_ = false;
  int jumps_ = 0;
  int jumps_seen_ = 0;  // the worker's
  std::atomic<std::uint64_t> out_of_order_{0};
  SentenceThrottle errors_{10.0};
  SentenceThrottle oddities_{60.0};
  SentenceThrottle failures_{10.0};  // the worker's
};

DisparityNodelet::~DisparityNodelet() { shutDown(); }

void DisparityNodelet::shutDown() {
  {
    const std::lock_guard<std::mutex> lock(connect_mutex_);
    shutting_down_ = true;
  }
  // Callbacks go first, since what they belong to must not be taken down around them: the
  // reconfigure server is none that waits for its own. Then what could call us, then the worker,
  // which publishes, then the outputs.
  if (mailbox_) mailbox_->stop();
  motion_thread_.stop();
  main_thread_.stop();
  reconfigure_.reset();
  if (diagnostics_) diagnostics_->stop();
  if (sync_) sync_->unsubscribe();
  if (motion_) motion_->unsubscribe();
  if (processor_) processor_->cancel();
  if (worker_.joinable()) worker_.join();
  if (outputs_) outputs_->stop();
}

void DisparityNodelet::onInit() {
  try {
    setUp();
  } catch (const std::exception& error) {
    // The loader swallows the reason.
    NODELET_FATAL("%s: %s", getName().c_str(), error.what());
    shutDown();
    throw;
  }
}

void DisparityNodelet::setUp() {
  handle_ = main_thread_.handle(getNodeHandle());
  private_handle_ = main_thread_.handle(getPrivateNodeHandle());
  std::vector<std::string> warnings;
  config_ = readNodeConfig(privateParameters(private_handle_), warnings);
  processor_ = std::make_unique<FrameProcessor>(config_.processor);
  motion_ = std::make_unique<MotionSubscriber>(config_.motion);
  mailbox_ = std::make_unique<FrameMailbox>(
      config_.process_every_frame ? FrameMailbox::Mode::kEvery : FrameMailbox::Mode::kNewest);
  config_.image_transport = usableTransport(warnings);
  setUpSync();
  diagnostics_ = std::make_unique<NodeDiagnostics>(
      handle_, private_handle_, getName(), [this](NodeReport& report) { fillReport(report); });
  setUpReconfigure();
  reportStart(warnings);
  motion_->subscribe(motion_thread_.handle(getNodeHandle()));
  worker_ = std::thread([this] { work(); });
  const std::lock_guard<std::mutex> lock(connect_mutex_);
  outputs_ = std::make_unique<Outputs>(handle_, config_.process_every_frame ? kBurst : 1,
                                       [this] { onConnection(); });
  if (!config_.lazy) sync_->subscribe();
  motion_thread_.start();
  main_thread_.start();
}

std::string DisparityNodelet::usableTransport(std::vector<std::string>& warnings) {
  const std::string& wanted = config_.image_transport;
  std::string installed;
  const image_transport::ImageTransport transport(handle_);
  for (std::string name : transport.getLoadableTransports()) {
    name = name.substr(name.find('/') + 1);  // of "package/name"
    if (name == wanted) return wanted;
    installed += (installed.empty() ? "" : ", ") + name;
  }
  warnings.push_back("~image_transport is '" + wanted + "', which is not installed here (" +
                     installed + "); raw is used. Install its plugin, e.g. the package " + wanted +
                     "_image_transport, or correct the name");
  // Where image_transport itself looks.
  private_handle_.setParam("image_transport", "raw");
  return "raw";
}

void DisparityNodelet::setUpSync() {
  SyncOptions options;
  options.approximate = config_.approximate_sync;
  options.max_interval = config_.approximate_sync_max_interval;
  // Where every frame counts, a burst must not overrun the subscribers' queues.
  options.queue_size =
      config_.process_every_frame ? std::max(config_.queue_size, kBurst) : config_.queue_size;
  options.image_transport = config_.image_transport;
  sync_ = std::make_unique<StereoSync>(
      handle_, private_handle_, options, [this](const StereoPair& pair) { onPair(pair); },
      [this](const ros::Time& stamp) { onJump(stamp); });
}

void DisparityNodelet::setUpReconfigure() {
  reconfigure_ = std::make_unique<ReconfigureServer>(reconfigure_mutex_, private_handle_);
  reconfigure_->setCallback(
      [this](DisparityConfig& reconfigure, std::uint32_t) { onReconfigure(reconfigure); });
}

void DisparityNodelet::reportStart(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) NODELET_WARN("%s", warning.c_str());
  NODELET_INFO("kernels: %s; %s", simdTarget().c_str(), toString(config_).c_str());
  if (simdTarget() == "portable") {
    NODELET_WARN("built without Google Highway: the matcher runs without SIMD and is slow");
  }
#ifndef NDEBUG
  NODELET_WARN("debug build: the matcher is many times slower; build type Release flies");
#endif
}

// Main thread -------------------------------------------------------------------------------------

void DisparityNodelet::onConnection() {
  // The first connection may come while the publishers are still being made.
  const std::lock_guard<std::mutex> lock(connect_mutex_);
  if (!outputs_ || !config_.lazy || shutting_down_) return;
  try {
    subscribeIfWanted();
  } catch (const std::exception& error) {
    // It would end the process, whose other nodelets may be flying.
    NODELET_ERROR("the images could not be subscribed: %s", error.what());
  }
}

void DisparityNodelet::subscribeIfWanted() {
  if (outputs_->anybodyListens()) {
    sync_->subscribe();
  } else {
    sync_->unsubscribe();
  }
}

void DisparityNodelet::onPair(const StereoPair& pair) {
  InputLimits limits;
  limits.baseline = config_.baseline;
  if (config_.approximate_sync) limits.max_stamp_difference = config_.approximate_sync_max_interval;
  const InputVerdict verdict = checkPair(pair, limits, sync_->topics());
  for (const std::string& warning : verdict.warnings) {
    if (oddities_.pass(warning)) NODELET_WARN("%s", warning.c_str());
  }
  if (!verdict.ok()) {
    diagnostics_->onRefused(verdict.error);
    if (errors_.pass(verdict.error)) NODELET_ERROR("%s", verdict.error.c_str());
    return;
  }
  diagnostics_->onGoodPair(verdict.geometry, pair.left->header.frame_id);
  out_of_order_ = sync_->outOfOrder();
  diagnostics_->onReplaced(mailbox_->put(Frame{pair, verdict.geometry, jumps_}));
}

void DisparityNodelet::onJump(const ros::Time& stamp) {
  ++jumps_;
  // Where every frame counts, those of before are still matched, and the worker goes on from there.
  if (config_.process_every_frame) return;
  diagnostics_->onReplaced(mailbox_->clear());
  motion_->startOver(stamp);
}

void DisparityNodelet::onReconfigure(DisparityConfig& reconfigure) {
  std::vector<std::string> warnings;
  {
    const std::lock_guard<std::mutex> lock(config_mutex_);
    // The first call only repeats the parameter server, which was read, with its warnings, before.
    if (reconfigured_once_) {
      config_.processor = fromReconfigure(reconfigure, config_.processor, warnings);
      config_changed_ = true;
    }
    reconfigured_once_ = true;
    reconfigure = toReconfigure(config_.processor);
  }
  for (const std::string& warning : warnings) NODELET_WARN("%s", warning.c_str());
}

void DisparityNodelet::fillReport(NodeReport& report) {
  report.sync = sync_->status();
  report.motion_inputs = motion_->status();
  report.expected_rate = config_.expected_rate;
  report.min_density = config_.min_density;
  const std::lock_guard<std::mutex> lock(config_mutex_);
  report.target_period = config_.processor.target_period;
  report.threads = config_.processor.matcher.threads;
}

// Worker ------------------------------------------------------------------------------------------

void DisparityNodelet::work() {
  Frame frame;
  while (mailbox_->take(frame)) {
    try {
      processFrame(frame);
    } catch (const MatchCancelled&) {
      return;
    } catch (const std::exception& error) {
      diagnostics_->onFailure(error.what());
      if (failures_.pass(error.what())) {
        NODELET_ERROR("a pair could not be processed and is dropped: %s", error.what());
      }
    }
    frame = Frame();
  }
}

void DisparityNodelet::processFrame(const Frame& frame) {
  {
    const std::lock_guard<std::mutex> lock(config_mutex_);
    if (config_changed_) processor_->setConfig(config_.processor);
    config_changed_ = false;
  }
  const std_msgs::Header& header = frame.pair.left->header;
  if (frame.jumps != jumps_seen_) {
    processor_->reset();
    if (config_.process_every_frame) motion_->startOver(header.stamp);
  }
  jumps_seen_ = frame.jumps;
  const Motion motion = motion_->waitForMotion(header.stamp, header.frame_id);
  FrameResult result = processor_->process(frame.pair, frame.geometry, motion);
  result.grid_state->latency = secondsBetween(header.stamp, ros::Time::now());
  result.grid_state->frames_dropped =
      static_cast<std::uint32_t>(diagnostics_->lost() + out_of_order_);
  outputs_->publish(result);
  diagnostics_->onMotion(motion);
  diagnostics_->onFrame(result);
  publishSideOutputs(result);
}

void DisparityNodelet::publishSideOutputs(const FrameResult& result) {
  try {
    outputs_->publish(processor_->makeSideOutputs(result, outputs_->wanted()));
    diagnostics_->onSideOutputs("");
  } catch (const std::exception& error) {
    diagnostics_->onSideOutputs(error.what());
    if (failures_.pass(error.what())) {
      NODELET_ERROR("a frame's depth, overlay or colours could not be made: %s", error.what());
    }
  }
}

}  // namespace adaptive_grid_stereo

PLUGINLIB_EXPORT_CLASS(adaptive_grid_stereo::DisparityNodelet, nodelet::Nodelet)
