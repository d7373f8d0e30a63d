#include "adaptive_grid_stereo/ros/frame_processor.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include <boost/make_shared.hpp>

#include "adaptive_grid_stereo/guidance/adaptive_grid.h"
#include "adaptive_grid_stereo/ros/conversions.h"
#include "adaptive_grid_stereo/ros/overlay.h"

namespace adaptive_grid_stereo {
namespace {

// Messages kept to be used again: while subscribers have all of them, further ones are not.
constexpr std::size_t kMostMessages = 4;

sensor_msgs::ImagePtr makeOverlay(const cv::Mat& left, const GridState& state) {
  auto message = boost::make_shared<sensor_msgs::Image>();
  const cv::Mat picture = drawGridOverlay(left, state, overlayScale(left.cols));
  message->header = state.header;
  message->width = static_cast<unsigned>(picture.cols);
  message->height = static_cast<unsigned>(picture.rows);
  message->encoding = "bgr8";
  message->step = message->width * 3;
  message->data.assign(picture.datastart, picture.dataend);
  return message;
}

double secondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

const ProcessorConfig& checked(const ProcessorConfig& config) {
  ProcessorConfig copy = config;
  const std::vector<std::string> changes = copy.validate();
  if (!changes.empty()) throw std::invalid_argument(changes.front());
  return config;
}

}  // namespace

std::vector<std::string> ProcessorConfig::validate() {
  std::vector<std::string> changes = matcher.validate();
  for (std::string& change : guidance.validate()) changes.push_back(std::move(change));
  if (!(target_period >= 0.0 && target_period <= 10.0)) {
    changes.push_back("target_period " + std::to_string(target_period) +
                      " changed to 0: it is a time of 0 to 10 s, 0 switches the governor off");
    target_period = 0.0;
  }
  if (mono16_bits != 0 && (mono16_bits < 8 || mono16_bits > 16)) {
    const int used = mono16_bits < 0 ? 0 : std::clamp(mono16_bits, 8, 16);
    changes.push_back("mono16_bits " + std::to_string(mono16_bits) + " changed to " +
                      std::to_string(used) + ": 8 to 16 bits, or 0 to see from the data");
    mono16_bits = used;
  }
  return changes;
}

FrameProcessor::FrameProcessor(const ProcessorConfig& config)
    : config_(checked(config)), matcher_(config.matcher) {}

void FrameProcessor::setConfig(const ProcessorConfig& config) {
  checked(config);
  matcher_.setConfig(config.matcher);
  config_ = config;
}

FrameResult FrameProcessor::process(const StereoPair& pair, const StereoGeometry& geometry,
                                    const Motion& motion) {
  const auto start = std::chrono::steady_clock::now();
  const std_msgs::Header& header = pair.left->header;
  const GreyPair grey = toGreyPair(*pair.left, *pair.right, config_.mono16_bits);

  FrameResult frame;
  const int step = config_.target_period > 0.0 ? governor_.step() : 0;
  const GuidanceConfig guidance = DeadlineGovernor::limitPaths(config_.guidance, step);
  frame.state = state_machine_.update(motion, header.stamp.toSec(), guidance);
  frame.plan =
      makePathPlan(frame.state, motion.forward_speed, guidance, grey.left.cols, grey.left.rows);

  const MatchResult& result = matcher_.match(grey.left, grey.right, frame.plan);
  frame.times = result.times;
  frame.disparity = freeMessage();
  fillDisparityImage(result, geometry, header, frame.disparity.get());
  frame.grid_state = toGridState(header, motion, frame.state, frame.plan,
                                 cellStatistics(result, geometry, frame.plan), guidance);
  frame.grid_state->governor_step = static_cast<std::uint8_t>(step);

  frame.left = grey.left;

  const double spent = secondsSince(start);
  frame.grid_state->processing_time = spent;
  governor_.update(spent + side_time_, config_.target_period);
  side_time_ = 0.0;
  return frame;
}

stereo_msgs::DisparityImagePtr FrameProcessor::freeMessage() {
  // To get fresh memory of an image's size from the system takes longer than to write the image.
  for (const stereo_msgs::DisparityImagePtr& message : messages_) {
    if (message.use_count() != 1) continue;
    std::atomic_thread_fence(std::memory_order_acquire);  // whoever had it has read it
    return message;
  }
  const auto message = boost::make_shared<stereo_msgs::DisparityImage>();
  if (messages_.size() < kMostMessages) messages_.push_back(message);
  return message;
}

SideOutputs FrameProcessor::makeSideOutputs(const FrameResult& frame, const WantedOutputs& wanted) {
  const auto start = std::chrono::steady_clock::now();
  SideOutputs outputs;
  if (wanted.depth) outputs.depth = toDepthImage(*frame.disparity);
  if (wanted.disparity_color) outputs.disparity_color = toColorImage(*frame.disparity);
  if (wanted.overlay) outputs.overlay = makeOverlay(frame.left, *frame.grid_state);
  side_time_ += secondsSince(start);
  return outputs;
}

void FrameProcessor::reset() {
  state_machine_.reset();
  governor_.reset();
  side_time_ = 0.0;
}

}  // namespace adaptive_grid_stereo
