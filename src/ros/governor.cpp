#include "adaptive_grid_stereo/ros/governor.h"

#include <algorithm>

namespace adaptive_grid_stereo {

int DeadlineGovernor::update(double processing_time, double target_period) {
  if (target_period <= 0.0) {
    reset();
    return step_;
  }
  window_.push_back(processing_time);
  if (window_.size() > static_cast<std::size_t>(kWindow)) window_.erase(window_.begin());
  ++frames_since_up_;
  if (window_.size() < static_cast<std::size_t>(kWindow)) return step_;

  const double typical = median();
  if (typical > target_period) {
    frames_with_room_ = 0;
    if (step_ < kLastStep) stepDown();
  } else if (typical < kRoom * target_period && step_ > 0) {
    if (++frames_with_room_ >= patience_) stepUp();
  } else {
    frames_with_room_ = 0;
  }
  return step_;
}

double DeadlineGovernor::median() const {
  if (window_.empty()) return 0.0;
  std::vector<double> sorted = window_;
  const auto middle = sorted.begin() + sorted.size() / 2;
  std::nth_element(sorted.begin(), middle, sorted.end());
  return *middle;
}

void DeadlineGovernor::reset() { *this = DeadlineGovernor(); }

GuidanceConfig DeadlineGovernor::limitPaths(GuidanceConfig config, int step) {
  constexpr int kFocus[] = {16, 8, 8, 4};
  constexpr int kNear[] = {16, 8, 4, 4};
  constexpr int kFar[] = {16, 4, 4, 4};
  const int row = std::clamp(step, 0, kLastStep);
  config.paths_focus = std::min(config.paths_focus, kFocus[row]);
  config.paths_near = std::min(config.paths_near, kNear[row]);
  config.paths_far = std::min(config.paths_far, kFar[row]);
  // A uniform plan has no focus; its cells count as near ones.
  config.paths_unknown = std::min(config.paths_unknown, kNear[row]);
  return config;
}

void DeadlineGovernor::stepDown() {
  // Taken back soon after it was given: the next attempt waits twice as long.
  if (frames_since_up_ <= 2 * patience_) {
    patience_ = std::min(2 * patience_, kLongestPatience);
  } else {
    patience_ = kShortestPatience;
  }
  ++step_;
  window_.clear();
}

void DeadlineGovernor::stepUp() {
  --step_;
  window_.clear();
  frames_with_room_ = 0;
  frames_since_up_ = 0;
}

}  // namespace adaptive_grid_stereo
