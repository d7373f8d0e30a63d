#include "adaptive_grid_stereo/ros/stereo_sync.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>

#include <image_transport/image_transport.h>
#include <ros/ros.h>

#include "adaptive_grid_stereo/ros/stamps.h"
#include "adaptive_grid_stereo/ros/stereo_pairing.h"
#include "rate_meter.h"

namespace adaptive_grid_stereo {
namespace {

using sensor_msgs::CameraInfoConstPtr;
using sensor_msgs::ImageConstPtr;

double steadyNow() { return ros::SteadyTime::now().toSec(); }

std::string inMilliseconds(double seconds) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.1f ms", 1e3 * seconds);
  return text;
}

/// Stamps of an input to compare with others'.
constexpr std::size_t kStampsKept = 32;
/// Jumps within kJumpMemory that no looped recording makes.
constexpr std::uint64_t kManyJumps = 3;
/// Clocks that differ by more are not those of cameras that are triggered together [s].
constexpr double kClocksDiffer = 1.0;

struct Input {
  std::uint64_t received = 0;
  RateMeter meter;
  double last_arrival = 0.0;
  std::deque<ros::Time> stamps;
};

/// The step from any of `left` to any of `right` that is smallest by its size [s].
double smallestStep(const std::deque<ros::Time>& left, const std::deque<ros::Time>& right) {
  double smallest = 0.0;
  bool found = false;
  for (const ros::Time& l : left) {
    for (const ros::Time& r : right) {
      const double step = secondsBetween(l, r);
      if (found && std::abs(step) >= std::abs(smallest)) continue;
      smallest = step;
      found = true;
    }
  }
  return smallest;
}

/// What keeps four inputs that all arrive from becoming pairs, with the cure.
std::string stampAdvice(const SyncStatus& status) {
  const InputStatus* worst = &status.inputs[1];
  for (const InputStatus& input : status.inputs) {
    if (input.newest_stamp == 0.0) {
      return "The stamps on " + input.topic + " are 0: its driver must set them.";
    }
    if (std::abs(input.offset) > std::abs(worst->offset)) worst = &input;
  }
  if (status.repeated > 0) {
    return "All inputs arrive and match, but their stamps do not advance, so the pairs are dropped "
           "as repeated ones: the driver must stamp every image anew.";
  }
  if (worst->offset == 0.0) {
    return "All inputs arrive, with equal stamps, but so far apart in time that the first of them "
           "are gone when the last ones come: raise queue_size.";
  }
  const std::string apart = "All inputs arrive, but the stamps on " + worst->topic +
                            " are never nearer than " + inMilliseconds(std::abs(worst->offset)) +
                            " to those on " + status.inputs[0].topic;
  if (std::abs(worst->offset) > kClocksDiffer) {
    return apart + "; are they of two clocks, or is one stale?";
  }
  return apart +
         (status.approximate
              ? "; raise approximate_sync_max_interval or queue_size, or trigger the cameras "
                "together."
              : "; exact synchronisation wants equal stamps: set approximate_sync, or trigger the "
                "cameras together.");
}

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
  return head + stampAdvice(status) + " Inputs:" + counts;
}

std::string jumpAdvice(const SyncStatus& status) {
  if (status.jumps_lately < kManyJumps) return "";
  std::string advice = "stamps jumped back " + std::to_string(status.jumps_lately) + " times in " +
                       std::to_string(static_cast<int>(StereoSync::kJumpMemory)) +
                       " s, and each time all starts over";
  for (const InputStatus& input : status.inputs) {
    if (input.publishers < 2) continue;
    return advice + "; " + input.topic + " has " + std::to_string(input.publishers) +
           " publishers: stop all but one (rostopic info)";
  }
  return advice + "; does the driver's clock go back and forth?";
}

struct StereoSync::Impl {
  Impl(const ros::NodeHandle& handle_in, const ros::NodeHandle& private_handle_in,
       const SyncOptions& options_in, PairCallback on_pair_in, JumpCallback on_jump_in)
      : handle(handle_in),
        private_handle(private_handle_in),
        options(options_in),
        transport(handle),
        on_pair(std::move(on_pair_in)),
        on_jump(std::move(on_jump_in)),
        pairing(
            {options.approximate, options.max_interval, options.queue_size},
            [this](const ReceivedPair& received) { onPair(received.pair); },
            [this](const ros::Time& stamp) { onJump(stamp); }) {
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
    pairing.startOver();
    const image_transport::TransportHints hints(options.image_transport, ros::TransportHints(),
                                                private_handle);
    const auto depth = static_cast<unsigned>(options.queue_size);
    left = transport.subscribe(topics.left_image, depth, &Impl::addLeft, this, hints);
    right = transport.subscribe(topics.right_image, depth, &Impl::addRight, this, hints);
    left_info = handle.subscribe(topics.left_info, depth, &Impl::addLeftInfo, this);
    right_info = handle.subscribe(topics.right_info, depth, &Impl::addRightInfo, this);
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
    for (Input& input : inputs) {
      input.meter.clear();
      input.stamps.clear();
    }
    pair_meter.clear();
  }

  // Messages ------------------------------------------------------------------------------------
  void addLeft(const ImageConstPtr& image) {
    pairing.addLeft(image, arrival(0, image->header.stamp));
  }
  void addRight(const ImageConstPtr& image) {
    pairing.addRight(image, arrival(1, image->header.stamp));
  }
  void addLeftInfo(const CameraInfoConstPtr& info) {
    pairing.addLeftInfo(info, arrival(2, info->header.stamp));
  }
  void addRightInfo(const CameraInfoConstPtr& info) {
    pairing.addRightInfo(info, arrival(3, info->header.stamp));
  }

  /// Notes that a message has come on that input; returns the time.
  ros::Time arrival(int index, const ros::Time& stamp) {
    Input& input = inputs[index];
    input.stamps.push_back(stamp);
    if (input.stamps.size() > kStampsKept) input.stamps.pop_front();
    ++input.received;
    input.last_arrival = steadyNow();
    input.meter.tick(input.last_arrival);
    return ros::Time::now();
  }

  void onPair(const StereoPair& pair) {
    last_pair = steadyNow();
    pair_meter.tick(last_pair);
    ++pairs;
    dropped_before = pairing.dropped();
    max_stamp_difference =
        std::max(max_stamp_difference,
                 std::abs(secondsBetween(pair.right->header.stamp, pair.left->header.stamp)));
    on_pair(pair);
  }

  void onJump(const ros::Time& stamp) {
    on_jump(stamp);
    const double now = steadyNow();
    jumps.push_back(now);
    if (now < next_jump_note) return;
    next_jump_note = now + kJumpMemory;
    const std::string advice = jumpAdvice(status());
    if (advice.empty()) {
      ROS_INFO("%s: stamps jumped; synchronisation and motion start over",
               topics.left_image.c_str());
    } else {
      ROS_WARN("%s: %s", private_handle.getNamespace().c_str(), advice.c_str());
    }
  }

  std::uint64_t jumpsLately(double now) {
    while (!jumps.empty() && jumps.front() < now - kJumpMemory) jumps.pop_front();
    return jumps.size();
  }

  // Reports -------------------------------------------------------------------------------------
  SyncStatus status() {
    const double now = steadyNow();
    SyncStatus report;
    report.subscribed = subscribed;
    report.approximate = options.approximate;
    report.silence = now - last_pair;
    const std::string* names[] = {&topics.left_image, &topics.right_image, &topics.left_info,
                                  &topics.right_info};
    for (int i = 0; i < 4; ++i) {
      InputStatus& input = report.inputs[i];
      input.topic = *names[i];
      input.received = inputs[i].received;
      input.rate = inputs[i].meter.rate(now);
      input.silence = now - inputs[i].last_arrival;
      input.newest_stamp = inputs[i].stamps.empty() ? 0.0 : inputs[i].stamps.back().toSec();
      // Asked for with every pair, too, when nobody needs it.
      if (report.silence >= kPatience) {
        input.offset = smallestStep(inputs[0].stamps, inputs[i].stamps);
      }
    }
    if (subscribed) {
      report.inputs[0].publishers = left.getNumPublishers();
      report.inputs[1].publishers = right.getNumPublishers();
      report.inputs[2].publishers = left_info.getNumPublishers();
      report.inputs[3].publishers = right_info.getNumPublishers();
    }
    report.pairs = pairs;
    report.out_of_order = pairing.dropped();
    report.unmatched =
        inputs[0].received - std::min(inputs[0].received, pairs + report.out_of_order);
    report.repeated = report.out_of_order - dropped_before;
    report.clock_jumps = pairing.clockJumps();
    report.jumps_lately = jumpsLately(now);
    report.pair_rate = pair_meter.rate(now);
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
  std::array<Input, 4> inputs;
  StereoPairing pairing;
  double last_pair = 0.0;
  RateMeter pair_meter;
  std::uint64_t pairs = 0;
  double max_stamp_difference = 0.0;
  std::uint64_t dropped_before = 0;  // the last pair
  std::deque<double> jumps;          // times [s] of the last ones
  double next_advice = 0.0;
  double next_jump_note = 0.0;
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
std::uint64_t StereoSync::outOfOrder() const { return impl_->pairing.dropped(); }

}  // namespace adaptive_grid_stereo
