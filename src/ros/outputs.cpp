#include "outputs.h"

#include <algorithm>

namespace adaptive_grid_stereo {
namespace {

/// Small, and recorded more often than shown: a reader that stalls for a moment misses none.
constexpr std::uint32_t kStates = 20;

}  // namespace

Outputs::Outputs(const ros::NodeHandle& handle, std::uint32_t queue_size,
                 std::function<void()> on_change)
    : handle_(handle), transport_(handle) {
  const ros::SubscriberStatusCallback on_topic =
      [on_change](const ros::SingleSubscriberPublisher&) { on_change(); };
  const image_transport::SubscriberStatusCallback on_image =
      [on_change](const image_transport::SingleSubscriberPublisher&) { on_change(); };
  disparity_ =
      handle_.advertise<stereo_msgs::DisparityImage>("disparity", queue_size, on_topic, on_topic);
  grid_state_ =
      handle_.advertise<GridState>("grid_state", std::max(queue_size, kStates), on_topic, on_topic);
  depth_ = transport_.advertise("depth", queue_size, on_image, on_image);
  overlay_ = transport_.advertise("grid_overlay", queue_size, on_image, on_image);
  disparity_color_ = transport_.advertise("disparity_color", queue_size, on_image, on_image);
}

bool Outputs::anybodyListens() const {
  const WantedOutputs side = wanted();
  return disparity_.getNumSubscribers() > 0 || grid_state_.getNumSubscribers() > 0 || side.depth ||
         side.overlay || side.disparity_color;
}

WantedOutputs Outputs::wanted() const {
  WantedOutputs wanted;
  wanted.depth = depth_.getNumSubscribers() > 0;
  wanted.overlay = overlay_.getNumSubscribers() > 0;
  wanted.disparity_color = disparity_color_.getNumSubscribers() > 0;
  return wanted;
}

void Outputs::publish(const FrameResult& frame) const {
  if (disparity_.getNumSubscribers() > 0) disparity_.publish(frame.disparity);
  if (grid_state_.getNumSubscribers() > 0) grid_state_.publish(frame.grid_state);
}

void Outputs::publish(const SideOutputs& side) const {
  if (side.depth) depth_.publish(side.depth);
  if (side.overlay) overlay_.publish(side.overlay);
  if (side.disparity_color) disparity_color_.publish(side.disparity_color);
}

void Outputs::stop() {
  disparity_.shutdown();
  grid_state_.shutdown();
  depth_.shutdown();
  overlay_.shutdown();
  disparity_color_.shutdown();
}

}  // namespace adaptive_grid_stereo
