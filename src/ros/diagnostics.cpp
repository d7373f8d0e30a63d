#include "adaptive_grid_stereo/ros/diagnostics.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <diagnostic_msgs/DiagnosticStatus.h>

#include "adaptive_grid_stereo/matching/stereo_matcher.h"
#include "rate_meter.h"

namespace adaptive_grid_stereo {
namespace {

using diagnostic_msgs::DiagnosticStatus;
using diagnostic_updater::DiagnosticStatusWrapper;

/// Frames older than this do not count in the statistics [s].
constexpr double kWindow = 5.0;
/// Pairs below this share of the expected rate are too few.
constexpr double kRateTolerance = 0.9;
/// Pairs replaced by newer ones, of those that came, above which the node does not keep up.
constexpr double kMostReplaced = 0.1;
/// A stamp that lies ahead of the clock by more than this is wrong [s].
constexpr double kFutureTolerance = 0.1;

double steadyNow() { return ros::SteadyTime::now().toSec(); }

struct Spread {
  double mean = 0.0;
  double max = 0.0;
};

template <typename Value>
Spread spread(const std::deque<FrameRecord>& frames, Value value) {
  Spread result;
  if (frames.empty()) return result;
  result.max = value(frames.front());
  for (const FrameRecord& frame : frames) {
    result.mean += value(frame) / static_cast<double>(frames.size());
    result.max = std::max(result.max, value(frame));
  }
  return result;
}

template <typename Value>
void addSpread(DiagnosticStatusWrapper& status, const std::string& name,
               const std::deque<FrameRecord>& frames, Value value) {
  const Spread result = spread(frames, value);
  status.addf(name, "%.2f mean, %.2f max", result.mean, result.max);
}

double frameRate(const NodeReport& report) {
  const auto& frames = report.frames;
  if (frames.empty()) return 0.0;
  return rateOf(frames.size(), frames.front().time, frames.back().time, report.now);
}

bool idle(const NodeReport& report, DiagnosticStatusWrapper& status) {
  if (report.sync.subscribed) return false;
  status.summary(DiagnosticStatus::OK, "idle: nobody listens to an output");
  return true;
}

}  // namespace

void describeInputs(const NodeReport& report, DiagnosticStatusWrapper& status) {
  std::string silent;
  for (const InputStatus& input : report.sync.inputs) {
    char last[32] = "none";
    if (input.received > 0) std::snprintf(last, sizeof(last), "last %.1f s ago", input.silence);
    status.addf(input.topic, "%llu messages, %.1f Hz, %s, %u publishers",
                static_cast<unsigned long long>(input.received), input.rate, last,
                input.publishers);
    if (input.silence > StereoSync::kPatience) silent += " " + input.topic;
  }
  if (idle(report, status)) return;
  if (silent.empty()) {
    status.summary(DiagnosticStatus::OK, "all four inputs arrive");
  } else {
    status.summary(DiagnosticStatus::ERROR, "nothing arrives on" + silent);
  }
}

void describeSynchronisation(const NodeReport& report, DiagnosticStatusWrapper& status) {
  const SyncStatus& sync = report.sync;
  status.add("Policy", sync.approximate ? "approximate" : "exact");
  status.add("Pairs", sync.pairs);
  status.addf("Pairs per second", "%.1f", sync.pair_rate);
  status.add("Left images without partners", sync.unmatched);
  status.add("Late or repeated pairs", sync.out_of_order);
  status.add("Clock jumps", sync.clock_jumps);
  status.addf("Largest stamp difference left-right [ms]", "%.2f", 1e3 * sync.max_stamp_difference);
  if (idle(report, status)) return;
  const std::string advice = syncAdvice(sync), jumps = jumpAdvice(sync);
  if (!advice.empty()) {
    status.summary(DiagnosticStatus::ERROR, advice);
  } else if (!jumps.empty()) {
    status.summary(DiagnosticStatus::WARN, jumps);
  } else {
    status.summary(DiagnosticStatus::OK, "pairs arrive");
  }
}

void describeCalibration(const NodeReport& report, DiagnosticStatusWrapper& status) {
  if (report.has_geometry) {
    status.addf("Focal length [px]", "%.3f", report.geometry.focal_length);
    status.addf("Baseline [m]", "%.5f", report.geometry.baseline);
    status.add("Baseline from", report.geometry.baseline_source);
    status.addf("cx left - cx right [px]", "%.3f", report.geometry.center_offset);
  }
  status.add("Pairs refused", report.refused);
  if (!report.error.empty()) {
    status.summary(DiagnosticStatus::ERROR, report.error);
  } else if (!report.has_geometry) {
    status.summary(DiagnosticStatus::OK, "no pair yet");
  } else {
    status.summary(DiagnosticStatus::OK, "images and calibration fit");
  }
}

void describeOutput(const NodeReport& report, DiagnosticStatusWrapper& status) {
  const double rate = frameRate(report);
  const Spread latency = spread(report.frames, [](const auto& frame) { return frame.latency; });
  status.addf("Frames per second", "%.2f", rate);
  status.addf("Expected [Hz]", "%.2f", report.expected_rate);
  status.addf("Latency [ms]", "%.1f mean, %.1f max", 1e3 * latency.mean, 1e3 * latency.max);
  status.add("Frames published", report.processed);
  status.add("Frames without their depth or pictures", report.side_failed);
  if (idle(report, status)) return;
  status.summary(DiagnosticStatus::OK, report.frames.empty() ? "no frame yet" : "frames come");
  if (report.expected_rate > 0.0 && rate < kRateTolerance * report.expected_rate) {
    status.mergeSummaryf(DiagnosticStatus::WARN, "%.1f frames per second, %.1f expected", rate,
                         report.expected_rate);
  }
  if (!report.frames.empty() && latency.mean < -kFutureTolerance) {
    status.mergeSummary(DiagnosticStatus::WARN,
                        "image stamps lie in the future; synchronise the camera's clock");
  }
  if (!report.side_failure.empty()) {
    status.mergeSummary(DiagnosticStatus::WARN,
                        "depth, overlay or colours could not be made: " + report.side_failure);
  }
}

void describeProcessing(const NodeReport& report, DiagnosticStatusWrapper& status) {
  const auto& frames = report.frames;
  addSpread(status, "Frame [ms]", frames, [](const auto& f) { return 1e3 * f.processing_time; });
  addSpread(status, "Census [ms]", frames, [](const auto& f) { return f.stages.census; });
  addSpread(status, "Sweeps [ms]", frames, [](const auto& f) { return f.stages.sweeps; });
  addSpread(status, "Refinement [ms]", frames, [](const auto& f) { return f.stages.refinement; });
  addSpread(status, "Matcher [ms]", frames, [](const auto& f) { return f.stages.total; });
  const int step = frames.empty() ? 0 : frames.back().governor_step;
  status.add("Governor step", step);
  status.addf("Target period [ms]", "%.1f", 1e3 * report.target_period);
  status.add("Frames replaced by newer ones", report.replaced);
  status.add("Frames failed", report.failed);
  status.add("SIMD target", simdTarget());
  status.add("Threads (0: all cores)", report.threads);
#ifdef NDEBUG
  status.add("Build", "optimised");
  status.summary(DiagnosticStatus::OK, "keeps up");
#else
  status.add("Build", "debug");
  status.summary(DiagnosticStatus::WARN,
                 "debug build, many times slower; build type Release flies");
#endif
  if (!report.failure.empty()) {
    status.mergeSummary(DiagnosticStatus::ERROR,
                        "the newest pair could not be processed: " + report.failure);
  }
  const std::size_t came = frames.size() + report.replaced_lately;
  if (static_cast<double>(report.replaced_lately) > kMostReplaced * static_cast<double>(came)) {
    status.mergeSummaryf(DiagnosticStatus::WARN,
                         "pairs come faster than they can be matched: %llu of the last %zu were "
                         "replaced by newer ones; a smaller disparity_range or image, more "
                         "threads, or target_period",
                         static_cast<unsigned long long>(report.replaced_lately), came);
  }
  if (step > 0) {
    status.mergeSummaryf(DiagnosticStatus::WARN,
                         "governor at step %d: paths were taken away to keep target_period", step);
  }
}

void describeMotion(const NodeReport& report, DiagnosticStatusWrapper& status) {
  const Motion& motion = report.motion;
  status.addf("Forward speed [m/s]", "%.2f", motion.forward_speed);
  status.addf("Yaw rate [rad/s]", "%.3f", motion.yaw_rate);
  status.addf("Pitch rate [rad/s]", "%.3f", motion.pitch_rate);
  status.addf("Speed from", "%s, %.3f s old", motion.speed_source.c_str(), motion.speed_age);
  status.addf("Rates from", "%s, %.3f s old", motion.rate_source.c_str(), motion.rate_age);
  status.add("Mounting of the camera", report.motion_inputs.mounting);
  for (const MotionSourceStatus& source : report.motion_inputs.sources) {
    status.addf(source.name + " " + source.topic,
                "%llu messages, %.1f Hz, %llu invalid, %llu late, %llu twice, %llu gaps, "
                "%llu clock jumps, %llu from the future%s%s",
                static_cast<unsigned long long>(source.received), source.rate,
                static_cast<unsigned long long>(source.invalid),
                static_cast<unsigned long long>(source.out_of_order),
                static_cast<unsigned long long>(source.duplicates),
                static_cast<unsigned long long>(source.gaps),
                static_cast<unsigned long long>(source.clock_jumps),
                static_cast<unsigned long long>(source.future),
                source.last_error.empty() ? "" : "; ", source.last_error.c_str());
  }
  if (idle(report, status)) return;
  if (report.frames.empty()) {
    status.summary(DiagnosticStatus::OK, "no frame yet");
  } else if (motion.valid) {
    status.summary(DiagnosticStatus::OK, "motion is known");
  } else {
    status.summary(DiagnosticStatus::WARN, "uniform plan: " + motion.reason);
  }
  if (!report.motion_inputs.warning.empty()) {
    status.mergeSummary(DiagnosticStatus::WARN, report.motion_inputs.warning);
  }
}

void describeScene(const NodeReport& report, DiagnosticStatusWrapper& status) {
  const Spread density = spread(report.frames, [](const auto& frame) { return frame.density; });
  status.addf("Valid pixels [%]", "%.1f", 1e2 * density.mean);
  status.addf("Warning below [%]", "%.1f", 1e2 * report.min_density);
  if (idle(report, status)) return;
  if (report.frames.empty()) {
    status.summary(DiagnosticStatus::OK, "no frame yet");
  } else if (density.mean < report.min_density) {
    status.summaryf(DiagnosticStatus::WARN,
                    "only %.1f %% of the pixels have a disparity: lens cap, fog, darkness, lost "
                    "calibration, or images not rectified?",
                    1e2 * density.mean);
  } else {
    status.summary(DiagnosticStatus::OK, "enough texture");
  }
}

NodeDiagnostics::NodeDiagnostics(const ros::NodeHandle& handle,
                                 const ros::NodeHandle& private_handle, const std::string& name,
                                 std::function<void(NodeReport&)> fill)
    : fill_(std::move(fill)), updater_(handle, private_handle, name) {
  updater_.setHardwareID("stereo camera");
  const auto task = [this](const char* title,
                           void (*describe)(const NodeReport&, DiagnosticStatusWrapper&)) {
    updater_.add(title,
                 [this, describe](DiagnosticStatusWrapper& status) { describe(current_, status); });
  };
  task("Inputs", describeInputs);
  task("Synchronisation", describeSynchronisation);
  task("Calibration", describeCalibration);
  task("Disparity output", describeOutput);
  task("Processing", describeProcessing);
  task("Motion", describeMotion);
  task("Scene", describeScene);
  // Not the updater's own pace: that one sleeps for ever when the simulated clock jumps back.
  ros::NodeHandle timers = handle;
  timer_ = timers.createSteadyTimer(ros::WallDuration(1.0),
                                    [this](const ros::SteadyTimerEvent&) { update(); });
}

void NodeDiagnostics::onGoodPair(const StereoGeometry& geometry, const std::string& frame) {
  const std::lock_guard<std::mutex> lock(mutex_);
  report_.geometry = geometry;
  report_.has_geometry = true;
  report_.error.clear();
  frame_ = frame;
}

void NodeDiagnostics::onRefused(const std::string& error) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++report_.refused;
  report_.error = error;
}

void NodeDiagnostics::onReplaced(std::uint64_t count) {
  const std::lock_guard<std::mutex> lock(mutex_);
  report_.replaced += count;
  replacements_.insert(replacements_.end(), count, steadyNow());
}

void NodeDiagnostics::onFailure(const std::string& error) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++report_.failed;
  report_.failure = error;
}

void NodeDiagnostics::onSideOutputs(const std::string& error) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!error.empty()) ++report_.side_failed;
  report_.side_failure = error;
}

void NodeDiagnostics::onMotion(const Motion& motion) {
  const std::lock_guard<std::mutex> lock(mutex_);
  report_.motion = motion;
}

void NodeDiagnostics::onFrame(const FrameResult& frame) {
  const GridState& state = *frame.grid_state;
  FrameRecord record;
  record.time = steadyNow();
  record.latency = state.latency;
  record.processing_time = state.processing_time;
  record.stages = frame.times;
  record.governor_step = state.governor_step;
  double pixels = 0.0;
  for (int cell = 0; cell < 9; ++cell) {
    const double area = static_cast<double>(frame.plan.column_edges[cell % 3 + 1] -
                                            frame.plan.column_edges[cell % 3]) *
                        (frame.plan.row_edges[cell / 3 + 1] - frame.plan.row_edges[cell / 3]);
    if (area > 0.0) record.density += state.density[cell] * area;
    pixels += area;
  }
  record.density /= pixels;
  const std::lock_guard<std::mutex> lock(mutex_);
  ++report_.processed;
  report_.failure.clear();
  report_.frames.push_back(record);
  while (report_.frames.front().time < record.time - kWindow) report_.frames.pop_front();
}

std::uint64_t NodeDiagnostics::lost() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return report_.replaced + report_.refused + report_.failed;
}

void NodeDiagnostics::stop() { timer_.stop(); }

void NodeDiagnostics::update() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const double oldest = steadyNow() - kWindow;
    while (!report_.frames.empty() && report_.frames.front().time < oldest) {
      report_.frames.pop_front();
    }
    while (!replacements_.empty() && replacements_.front() < oldest) replacements_.pop_front();
    report_.replaced_lately = replacements_.size();
    current_ = report_;
    if (!frame_.empty()) updater_.setHardwareID(frame_);
  }
  current_.now = steadyNow();
  fill_(current_);
  updater_.force_update();
}

}  // namespace adaptive_grid_stereo
