#include "adaptive_grid_stereo/ros/stereo_pairing.h"

#include <utility>

#include <message_filters/sync_policies/approximate_time.h>
#include <message_filters/sync_policies/exact_time.h>
#include <message_filters/synchronizer.h>

#include "adaptive_grid_stereo/ros/stamps.h"

namespace adaptive_grid_stereo {
namespace {

using sensor_msgs::CameraInfo;
using sensor_msgs::Image;
using ExactPolicy = message_filters::sync_policies::ExactTime<Image, Image, CameraInfo, CameraInfo>;
using ApproximatePolicy =
    message_filters::sync_policies::ApproximateTime<Image, Image, CameraInfo, CameraInfo>;
template <typename Message>
using Event = ros::MessageEvent<const Message>;

/// So many late pairs in a row mean that the stamps started over by less than
/// StampWatch::kJump.
constexpr int kLatePairsOfAJump = 5;

}  // namespace

struct StereoPairing::Impl {
  Impl(const PairingOptions& options_in, std::function<void(const ReceivedPair&)> on_pair_in,
       std::function<void(const ros::Time&)> on_jump_in)
      : options(options_in), on_pair(std::move(on_pair_in)), on_jump(std::move(on_jump_in)) {
    startOver();
  }

  template <int index, typename Message>
  void add(const boost::shared_ptr<const Message>& message, const ros::Time& received) {
    const ros::Time stamp = message->header.stamp;
    // The synchroniser is fed by hand, so that it can be replaced before a message goes in.
    if (stamps.startsOver(index, stamp)) {
      startOver();
      ++clock_jumps;
      on_jump(stamp);
    }
    const Event<Message> event(message, received);
    if (exact) exact->template add<index>(event);
    if (approximate) approximate->template add<index>(event);
  }

  void onPair(const Event<Image>& left, const Event<Image>& right,
              const Event<CameraInfo>& left_info, const Event<CameraInfo>& right_info) {
    const ros::Time stamp = left.getConstMessage()->header.stamp;
    // A driver that never stamps gives zeros; those count as new each time.
    if (!stamp.isZero() && stamp <= last_stamp) {
      ++dropped;
      if (++late_pairs < kLatePairsOfAJump || stamp == last_stamp) return;
      ++clock_jumps;
      on_jump(stamp);
    }
    late_pairs = 0;
    last_stamp = stamp;
    ReceivedPair pair;
    pair.pair = {left.getConstMessage(), right.getConstMessage(), left_info.getConstMessage(),
                 right_info.getConstMessage()};
    pair.received = left.getReceiptTime();
    on_pair(pair);
  }

  /// A fresh synchroniser, without memory; never from inside a synchroniser.
  void startOver() {
    last_stamp = ros::Time();
    late_pairs = 0;
    exact.reset();
    approximate.reset();
    const auto depth = static_cast<unsigned>(options.queue_size);
    if (options.approximate) {
      ApproximatePolicy policy(depth);
      if (options.max_interval > 0.0) {
        policy.setMaxIntervalDuration(ros::Duration(options.max_interval));
      }
      approximate =
          std::make_unique<message_filters::Synchronizer<ApproximatePolicy>>(std::move(policy));
      approximate->registerCallback(&Impl::onPair, this);
    } else {
      exact = std::make_unique<message_filters::Synchronizer<ExactPolicy>>(ExactPolicy(depth));
      exact->registerCallback(&Impl::onPair, this);
    }
  }

  PairingOptions options;
  std::function<void(const ReceivedPair&)> on_pair;
  std::function<void(const ros::Time&)> on_jump;
  std::unique_ptr<message_filters::Synchronizer<ExactPolicy>> exact;
  std::unique_ptr<message_filters::Synchronizer<ApproximatePolicy>> approximate;
  StampWatch stamps;
  ros::Time last_stamp;
  int late_pairs = 0;
  std::uint64_t dropped = 0;
  std::uint64_t clock_jumps = 0;
};

StereoPairing::StereoPairing(const PairingOptions& options,
                             std::function<void(const ReceivedPair&)> on_pair,
                             std::function<void(const ros::Time&)> on_jump)
    : impl_(std::make_unique<Impl>(options, std::move(on_pair), std::move(on_jump))) {}

StereoPairing::~StereoPairing() = default;

void StereoPairing::addLeft(const sensor_msgs::ImageConstPtr& image, const ros::Time& received) {
  impl_->add<0>(image, received);
}
void StereoPairing::addRight(const sensor_msgs::ImageConstPtr& image, const ros::Time& received) {
  impl_->add<1>(image, received);
}
void StereoPairing::addLeftInfo(const sensor_msgs::CameraInfoConstPtr& info,
                                const ros::Time& received) {
  impl_->add<2>(info, received);
}
void StereoPairing::addRightInfo(const sensor_msgs::CameraInfoConstPtr& info,
                                 const ros::Time& received) {
  impl_->add<3>(info, received);
}

void StereoPairing::startOver() { impl_->startOver(); }
std::uint64_t StereoPairing::dropped() const { return impl_->dropped; }
std::uint64_t StereoPairing::clockJumps() const { return impl_->clock_jumps; }

}  // namespace adaptive_grid_stereo
