#include "adaptive_grid_stereo/ros/stereo_sync.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <image_transport/image_transport.h>
#include <message_filters/sync_policies/approximate_time.h>
#include <message_filters/sync_policies/exact_time.h>
#include <message_filters/synchronizer.h>
#include <ros/ros.h>

#include "adaptive_grid_stereo/ros/stamps.h"
#include "rate_meter.h"

namespace adaptive_grid_stereo {
namespace {

using sensor_msgs::CameraInfo;
using sensor_msgs::CameraInfoConstPtr;
using sensor_msgs::Image;
using sensor_msgs::ImageConstPtr;
using ExactPolicy = message_filters::sync_policies::ExactTime<Image, Image, CameraInfo, CameraInfo>;
using ApproximatePolicy =
    message_filters::sync_policies::ApproximateTime<Image, Image, CameraInfo, CameraInfo>;

/// So many late pairs in a row mean that the stamps started over by less than
/// StampWatch::kJump.
constexpr int kLatePairsOfAJump = 5;

double steadyNow() { return ros::SteadyTime::now().toSec(); }

std::string inMilliseconds(double seconds) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.1f ms", 1e3 * seconds);
  return text;
}

struct Input {
  std::uint64_t received = 0;
  RateMeter meter;
  double last_arrival = 0.0;
};

}  // namespace

std::string syncAdvice(const SyncStatus& status) {
  if (!status.subscribed || status.silence < StereoSync::kPatience) return "";
  std::string counts;
  std::string silent;
  for (const InputStatus& input : status.inputs) {
    counts += "\n  " + input.topic + ": " + std::to_string(input.received) + " messages, " +
              std::to_string(input.publishers) + " publishers";
    if (input.silence >= StereoSync::kPatience) silent += " " + input.topic;
  }
  char head[64];
  std::snprintf(head, sizeof(head), "no stereo pair for %.0f s. ", status.silence);
  if (!silent.empty()) {
    return head +
           ("Nothing arrives on" + silent +
            "; check the driver and the remapping (rostopic list). Inputs:") +
           counts;
  }
  double oldest = status.inputs[0].newest_stamp;
  double newest = oldest;
  for (const InputStatus& input : status.inputs) {
    oldest = std::min(oldest, input.newest_stamp);
    newest = std::max(newest, input.newest_stamp);
  }
  const std::string apart =
      "All inputs arrive, but their stamps do not match (the newest ones lie " +
      inMilliseconds(newest - oldest) + " apart)";
  return head + apart +
         (status.approximate
              ? "; raise approximate_sync_max_interval or queue_size, or trigger the cameras "
                "together."
              : "; exact synchronisation wants equal stamps: set approximate_sync, or trigger the "
                "cameras together.") +
         " Inputs:" + counts;
}

struct StereoSync::Impl {
  Impl(const ros::NodeHandle& handle_in, const ros::NodeHandle& private_handle_in,
       const SyncOptions& options_in, PairCallback on_pair_in, JumpCallback on_jump_in)
      : handle(handle_in),
        private_handle(private_handle_in),
        options(options_in),
        transport(handle),
        on_pair(std::move(on_pair_in)),
        on_jump(std::move(on_jump_in)) {
    topics.left_image = handle.resolveName("left/image_rect");
    topics.right_image = handle.resolveName("right/image_rect");
    topics.left_info = handle.resolveName("left/camera_info");
    topics.right_info = handle.resolveName("right/camera_info");
  }

  // Subscriptions -------------------------------------------------------------------------------
  void subscribe() {
    if (subscribed) return;
    subscribed = true;
    last_pair = steadyNow();
    for (Input& input : inputs) input.last_arrival = last_pair;
    startOver();
    const image_transport::TransportHints hints(options.image_transport, ros::TransportHints(),
                                                private_handle);
    const auto depth = static_cast<unsigned>(options.queue_size);
    left = transport.subscribe(topics.left_image, depth, &Impl::addImage<0>, this, hints);
    right = transport.subscribe(topics.right_image, depth, &Impl::addImage<1>, this, hints);
    left_info = handle.subscribe(topics.left_info, depth, &Impl::addInfo<2>, this);
    right_info = handle.subscribe(topics.right_info, depth, &Impl::addInfo<3>, this);
    timer = handle.createSteadyTimer(ros::WallDuration(1.0), &Impl::onTimer, this);
  }

  void unsubscribe() {
    if (!subscribed) return;
    timer.stop();
    left.shutdown();
    right.shutdown();
    left_info.shutdown();
    right_info.shutdown();
    subscribed = false;
    for (Input& input : inputs) input.meter.clear();
    pair_meter.clear();
  }

  // Messages ------------------------------------------------------------------------------------
  template <int index>
  void addImage(const ImageConstPtr& message) {
    add<index>(message);
  }
  template <int index>
  void addInfo(const CameraInfoConstPtr& message) {
    add<index>(message);
  }

  /// The synchroniser is fed by hand, so that it can be replaced before a message goes in.
  template <int index, typename MessagePtr>
  void add(const MessagePtr& message) {
    if (stampsJump(index, message->header.stamp)) announceJump(message->header.stamp);
    if (exact) exact->template add<index>(message);
    if (approximate) approximate->template add<index>(message);
  }

  bool stampsJump(int index, const ros::Time& stamp) {
    Input& input = inputs[index];
    ++input.received;
    input.last_arrival = steadyNow();
    input.meter.tick(input.last_arrival);
    const bool jumped = stamps.startsOver(index, stamp);
    if (jumped) {
      startOver();
      ++clock_jumps;
    }
    return jumped;
  }

  void onPair(const ImageConstPtr& left_image, const ImageConstPtr& right_image,
              const CameraInfoConstPtr& left_camera, const CameraInfoConstPtr& right_camera) {
    bool jumped = false;
    {
      const ros::Time stamp = left_image->header.stamp;
      // A driver that never stamps gives zeros; those count as new each time.
      if (!stamp.isZero() && stamp <= last_stamp) {
        ++out_of_order;
        jumped = ++late_pairs >= kLatePairsOfAJump && stamp < last_stamp;
        if (!jumped) return;
        ++clock_jumps;
      }
      late_pairs = 0;
      last_stamp = stamp;
      last_pair = steadyNow();
      pair_meter.tick(last_pair);
      ++pairs;
      max_stamp_difference = std::max(max_stamp_difference,
                                      std::abs(secondsBetween(right_image->header.stamp, stamp)));
    }
    if (jumped) announceJump(left_image->header.stamp);
    on_pair(StereoPair{left_image, right_image, left_camera, right_camera});
  }

  void announceJump(const ros::Time& stamp) {
    ROS_INFO("%s: stamps jumped; synchronisation and motion start over", topics.left_image.c_str());
    on_jump(stamp);
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

  // Reports -------------------------------------------------------------------------------------
  SyncStatus status() {
    const double now = steadyNow();
    SyncStatus report;
    report.subscribed = subscribed;
    report.approximate = options.approximate;
    const std::string* names[] = {&topics.left_image, &topics.right_image, &topics.left_info,
                                  &topics.right_info};
    for (int i = 0; i < 4; ++i) {
      InputStatus& input = report.inputs[i];
      input.topic = *names[i];
      input.received = inputs[i].received;
      input.rate = inputs[i].meter.rate(now);
      input.silence = now - inputs[i].last_arrival;
      input.newest_stamp = stamps.newest(i).toSec();
    }
    if (subscribed) {
      report.inputs[0].publishers = left.getNumPublishers();
      report.inputs[1].publishers = right.getNumPublishers();
      report.inputs[2].publishers = left_info.getNumPublishers();
      report.inputs[3].publishers = right_info.getNumPublishers();
    }
    report.pairs = pairs;
    report.out_of_order = out_of_order;
    report.unmatched = inputs[0].received - std::min(inputs[0].received, pairs + out_of_order);
    report.clock_jumps = clock_jumps;
    report.pair_rate = pair_meter.rate(now);
    report.silence = now - last_pair;
    report.max_stamp_difference = max_stamp_difference;
    return report;
  }

  void onTimer(const ros::SteadyTimerEvent&) {
    const std::string advice = syncAdvice(status());
    if (advice.empty()) {
      next_advice = 0.0;
      return;
    }
    if (steadyNow() < next_advice) return;
    next_advice = steadyNow() + 2.0 * kPatience;
    ROS_WARN("%s: %s", private_handle.getNamespace().c_str(), advice.c_str());
  }

  ros::NodeHandle handle;
  ros::NodeHandle private_handle;
  const SyncOptions options;
  InputTopics topics;
  image_transport::ImageTransport transport;
  const PairCallback on_pair;
  const JumpCallback on_jump;

  image_transport::Subscriber left;
  image_transport::Subscriber right;
  ros::Subscriber left_info;
  ros::Subscriber right_info;
  ros::SteadyTimer timer;

  bool subscribed = false;
  std::unique_ptr<message_filters::Synchronizer<ExactPolicy>> exact;
  std::unique_ptr<message_filters::Synchronizer<ApproximatePolicy>> approximate;
  std::array<Input, 4> inputs;
  StampWatch stamps;
  ros::Time last_stamp;
  int late_pairs = 0;
  double last_pair = 0.0;
  RateMeter pair_meter;
  std::uint64_t pairs = 0;
  std::uint64_t out_of_order = 0;
  std::uint64_t clock_jumps = 0;
  double max_stamp_difference = 0.0;
  double next_advice = 0.0;
};

StereoSync::StereoSync(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle,
                       const SyncOptions& options, PairCallback on_pair, JumpCallback on_jump)
    : impl_(std::make_unique<Impl>(handle, private_handle, options, std::move(on_pair),
                                   std::move(on_jump))) {}

StereoSync::~StereoSync() { unsubscribe(); }

void StereoSync::subscribe() { impl_->subscribe(); }
void StereoSync::unsubscribe() { impl_->unsubscribe(); }
const InputTopics& StereoSync::topics() const { return impl_->topics; }
SyncStatus StereoSync::status() const { return impl_->status(); }

}  // namespace adaptive_grid_stereo
