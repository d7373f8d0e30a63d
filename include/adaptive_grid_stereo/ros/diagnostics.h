#ifndef ADAPTIVE_GRID_STEREO_ROS_DIAGNOSTICS_H
#define ADAPTIVE_GRID_STEREO_ROS_DIAGNOSTICS_H

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/node_handle.h>

#include "adaptive_grid_stereo/guidance/motion.h"
#include "adaptive_grid_stereo/matching/stereo_matcher.h"
#include "adaptive_grid_stereo/ros/frame_processor.h"
#include "adaptive_grid_stereo/ros/input_check.h"
#include "adaptive_grid_stereo/ros/motion_subscriber.h"
#include "adaptive_grid_stereo/ros/stereo_sync.h"

namespace adaptive_grid_stereo {

/// One processed frame, for the statistics.
struct FrameRecord {
  double time = 0.0;             // steady clock at publishing [s]
  double latency = 0.0;          // stamp to publishing [s]
  double processing_time = 0.0;  // [s]
  StageTimes stages;
  double density = 0.0;  // share of valid pixels [1]
  int governor_step = 0;
};

/// All that the node knows about itself at one moment.
struct NodeReport {
  double now = 0.0;  // steady clock [s]
  SyncStatus sync;
  MotionInputStatus motion_inputs;
  Motion motion;  // of the newest frame

  bool has_geometry = false;
  StereoGeometry geometry;  // of the newest good pair
  /// The newest refusal of a pair; empty if newer pairs were good.
  std::string error;
  /// Why the newest pair could not be processed, why depth, overlay or colours of the newest frame
  /// could not be made; empty if they were.
  std::string failure;
  std::string side_failure;

  std::deque<FrameRecord> frames;  // of the last seconds
  std::uint64_t processed = 0;
  std::uint64_t replaced = 0;
  std::uint64_t replaced_lately = 0;  // in the last seconds, as `frames`
  std::uint64_t refused = 0;
  std::uint64_t failed = 0;
  std::uint64_t side_failed = 0;

  double expected_rate = 0.0;  // [Hz], 0: none
  double min_density = 0.0;    // [1]
  double target_period = 0.0;  // [s], 0: governor off
  int threads = 0;
};

/// One diagnostic task each; pure.
void describeInputs(const NodeReport& report, diagnostic_updater::DiagnosticStatusWrapper& status);
void describeSynchronisation(const NodeReport& report,
                             diagnostic_updater::DiagnosticStatusWrapper& status);
void describeCalibration(const NodeReport& report,
                         diagnostic_updater::DiagnosticStatusWrapper& status);
void describeOutput(const NodeReport& report, diagnostic_updater::DiagnosticStatusWrapper& status);
void describeProcessing(const NodeReport& report,
                        diagnostic_updater::DiagnosticStatusWrapper& status);
void describeMotion(const NodeReport& report, diagnostic_updater::DiagnosticStatusWrapper& status);
void describeScene(const NodeReport& report, diagnostic_updater::DiagnosticStatusWrapper& status);

/// Collects what happens and publishes it once a second on /diagnostics. The on...() functions are
/// thread safe.
class NodeDiagnostics {
 public:
  /// fill: adds the parts of the report that others own (sync, motion inputs, settings); it is
  /// called in the callback queue of the handle.
  NodeDiagnostics(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle,
                  const std::string& name, std::function<void(NodeReport&)> fill);

  void onGoodPair(const StereoGeometry& geometry, const std::string& frame);
  void onRefused(const std::string& error);
  void onReplaced(std::uint64_t count);
  void onFailure(const std::string& error);
  void onMotion(const Motion& motion);
  void onFrame(const FrameResult& frame);
  /// The error with which a frame's side outputs failed, empty if they were made.
  void onSideOutputs(const std::string& error);

  /// Pairs that did not lead to a frame.
  std::uint64_t lost() const;

  /// No callback runs after it has returned.
  void stop();

 private:
  void update();

  mutable std::mutex mutex_;
  NodeReport report_;                // guarded
  std::string frame_;                // guarded
  std::deque<double> replacements_;  // guarded; when [s], in the last seconds
  NodeReport current_;               // of the update in progress
  std::function<void(NodeReport&)> fill_;
  diagnostic_updater::Updater updater_;
  ros::SteadyTimer timer_;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_ROS_DIAGNOSTICS_H
