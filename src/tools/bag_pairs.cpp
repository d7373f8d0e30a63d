#include "bag_pairs.h"

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

struct BagPairs::Impl {
  Impl(const PairingOptions& options_in, std::function<void(const RecordedPair&)> on_pair_in,
       std::function<void(const ros::Time&)> on_jump_in)
      : options(options_in), on_pair(std::move(on_pair_in)), on_jump(std::move(on_jump_in)) {
    startOver();
  }

  template <int index, typename Message>
  void add(const boost::shared_ptr<const Message>& message, const ros::Time& recorded) {
    const ros::Time stamp = message->header.stamp;
    if (stamps.startsOver(index, stamp)) {
      startOver();
      on_jump(stamp);
    }
    const Event<Message> event(message, recorded);
    if (exact) exact->template add<index>(event);
    if (approximate) approximate->template add<index>(event);
  }

  void onPair(const Event<Image>& left, const Event<Image>& right,
              const Event<CameraInfo>& left_info, const Event<CameraInfo>& right_info) {
    const ros::Time stamp = left.getConstMessage()->header.stamp;
    if (!stamp.isZero() && stamp <= last_stamp) {
      ++dropped;
      if (++late_pairs < kLatePairsOfAJump || stamp == last_stamp) return;
      on_jump(stamp);
    }
    late_pairs = 0;
    last_stamp = stamp;
    RecordedPair pair;
    pair.pair = {left.getConstMessage(), right.getConstMessage(), left_info.getConstMessage(),
                 right_info.getConstMessage()};
    pair.recorded = left.getReceiptTime();
    on_pair(pair);
  }

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
  std::function<void(const RecordedPair&)> on_pair;
  std::function<void(const ros::Time&)> on_jump;
  std::unique_ptr<message_filters::Synchronizer<ExactPolicy>> exact;
  std::unique_ptr<message_filters::Synchronizer<ApproximatePolicy>> approximate;
  StampWatch stamps;
  ros::Time last_stamp;
  int late_pairs = 0;
  long dropped = 0;
};

BagPairs::BagPairs(const PairingOptions& options, std::function<void(const RecordedPair&)> on_pair,
                   std::function<void(const ros::Time&)> on_jump)
    : impl_(std::make_unique<Impl>(options, std::move(on_pair), std::move(on_jump))) {}

BagPairs::~BagPairs() = default;

void BagPairs::addLeft(const sensor_msgs::ImageConstPtr& image, const ros::Time& recorded) {
  impl_->add<0>(image, recorded);
}
void BagPairs::addRight(const sensor_msgs::ImageConstPtr& image, const ros::Time& recorded) {
  impl_->add<1>(image, recorded);
}
void BagPairs::addLeftInfo(const sensor_msgs::CameraInfoConstPtr& info, const ros::Time& recorded) {
  impl_->add<2>(info, recorded);
}
void BagPairs::addRightInfo(const sensor_msgs::CameraInfoConstPtr& info,
                            const ros::Time& recorded) {
  impl_->add<3>(info, recorded);
}

long BagPairs::dropped() const { return impl_->dropped; }

}  // namespace adaptive_grid_stereo
