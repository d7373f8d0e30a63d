#include "adaptive_grid_stereo/ros/motion_subscriber.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include <tf2/buffer_core.h>

#include "adaptive_grid_stereo/guidance/motion_estimator.h"
#include "adaptive_grid_stereo/guidance/motion_history.h"
#include "adaptive_grid_stereo/guidance/sample_buffer.h"
#include "adaptive_grid_stereo/ros/stamps.h"
#include "motion_messages.h"
#include "mounting_lookup.h"

namespace adaptive_grid_stereo {

namespace {

constexpr double kTfCache = 30.0;         // [s]
constexpr double kFutureTolerance = 0.1;  // [s] by which stamps may lie ahead of the clock
/// Transforms that may come before the images' stamps follow theirs back.
constexpr std::size_t kMostAhead = 2000;
/// Stamps of a moving frame by which to tell how often its transforms come: those of the intervals
/// that SampleBuffer::period() looks at.
constexpr std::size_t kTransformStamps = 17;
/// Shortest time over which the directions of a camera on a gimbal are differenced [s].
constexpr double kShortestInterval = 0.05;

enum Source { kImu, kOdom, kGpsVel, kGpsFix, kMag, kSources };
constexpr const char* kNames[kSources] = {"imu", "odom", "gps_vel", "gps_fix", "mag"};
constexpr const char* kTopics[kSources] = {"imu", "odom", "gps/vel", "gps/fix", "mag"};

}  // namespace

struct MotionSubscriber::Impl {
  explicit Impl(const MotionConfig& wanted)
      : config(wanted), estimator(wanted), tf(ros::Duration(kTfCache)) {
    config.validate();
  }

  template <typename Message>
  void accept(Source source, const Message& message);
  template <typename Message>
  ros::Subscriber listen(ros::NodeHandle& nh, Source source);
  ros::Subscriber listenToTransforms(ros::NodeHandle& nh, const std::string& topic, bool is_static);
  void acceptTransforms(const tf2_msgs::TFMessage& message, bool is_static);
  void acceptTransform(const geometry_msgs::TransformStamped& transform, bool is_static);
  void noteTransform(const geometry_msgs::TransformStamped& transform);
  // Whether a transform is to be expected without which the camera's mounting at the stamp is not
  // quite known. Under the mutex.
  bool transformIsDue(const ros::Time& stamp, const std::string& optical_frame) const;
  MotionConfig currentConfig() const {
    const std::lock_guard<std::mutex> lock(mutex);
    return config;
  }

  mutable std::mutex mutex;  // of all that follows, down to the estimator
  std::condition_variable arrived;
  MotionConfig config;
  MotionSourceStatus status[kSources];
  std::string frames[kSources];  // of the latest message
  std::string mounting = "not asked for yet";
  MotionHistory history;
  bool live = false;
  bool gave_up = false;  // waiting for publishers that send nothing
  struct TransformStamp {
    double stamp;  // [s]
  };
  struct MovingFrame {
    ros::Time newest;
    bool stepped_back = false;
    SampleBuffer<TransformStamp> stamps{kTransformStamps};
  };
  std::map<std::string, MovingFrame> moving_frames;  // by child frame
  /// Transforms of frames whose stamps have stepped back while those of the images have not yet.
  std::deque<geometry_msgs::TransformStamped> ahead;
  bool await_transforms = false;  // there were some before the stamps started over

  MotionEstimator estimator;  // thread safe itself
  tf2::BufferCore tf;         // likewise
  std::vector<ros::Subscriber> subscribers;
};

template <typename Message>
void MotionSubscriber::Impl::accept(Source source, const Message& message) {
  std::string error;
  auto sample = toSample(message, &error);
  const bool used = sample && estimator.add(*sample);
  {
    const std::lock_guard<std::mutex> lock(mutex);
    MotionSourceStatus& mine = status[source];
    ++mine.received;
    if (!used) {
      ++mine.invalid;
      mine.last_error = error;
      return;
    }
    if (live && message.header.stamp > ros::Time::now() + ros::Duration(kFutureTolerance)) {
      ++mine.future;
    }
    if constexpr (std::is_same_v<Message, sensor_msgs::Imu> ||
                  std::is_same_v<Message, nav_msgs::Odometry>) {
      frames[source] = sample->frame;
    }
  }
  arrived.notify_all();
}

template <typename Message>
ros::Subscriber MotionSubscriber::Impl::listen(ros::NodeHandle& nh, Source source) {
  // Ten seconds of a fast Imu: a process that is kept from running for a while, or a recording that
  // is played at many times its speed, must not cost samples.
  constexpr std::uint32_t kQueue = 2000;
  return nh.subscribe<Message>(kTopics[source], kQueue,
                               boost::function<void(const boost::shared_ptr<const Message>&)>(
                                   [this, source](const boost::shared_ptr<const Message>& message) {
                                     accept(source, *message);
                                   }),
                               ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
}

void MotionSubscriber::Impl::acceptTransforms(const tf2_msgs::TFMessage& message, bool is_static) {
  for (geometry_msgs::TransformStamped transform : message.transforms) {
    if (!transform.child_frame_id.empty() && transform.child_frame_id[0] == '/') {
      transform.child_frame_id.erase(0, 1);
    }
    if (!transform.header.frame_id.empty() && transform.header.frame_id[0] == '/') {
      transform.header.frame_id.erase(0, 1);
    }
    acceptTransform(transform, is_static);
  }
  arrived.notify_all();
}

void MotionSubscriber::Impl::acceptTransform(const geometry_msgs::TransformStamped& transform,
                                             bool is_static) {
  if (!is_static) noteTransform(transform);
  try {
    // It refuses NaN and empty names by itself and says so.
    tf.setTransform(transform, "tf", is_static);
  } catch (const std::runtime_error&) {
    // Stamps within kTfCache of the largest one there is.
  }
}

void MotionSubscriber::Impl::noteTransform(const geometry_msgs::TransformStamped& transform) {
  const std::lock_guard<std::mutex> lock(mutex);
  MovingFrame& frame = moving_frames[transform.child_frame_id];
  const double step_back = secondsBetween(transform.header.stamp, frame.newest);
  frame.stepped_back = frame.stepped_back || step_back > StampWatch::kJump;
  if (frame.stepped_back) {
    ahead.push_back(transform);
    if (ahead.size() > kMostAhead) ahead.pop_front();
  }
  // TF ignores what lies farther back than its cache reaches. After one stamp from the future, or
  // when stamps start over, that would be everything.
  if (step_back > kTfCache) {
    tf.clear();
    frame.newest = ros::Time();
  }
  frame.newest = std::max(frame.newest, transform.header.stamp);
  frame.stamps.insert({transform.header.stamp.toSec()}, config.motion_timeout);
  await_transforms = false;
}

ros::Subscriber MotionSubscriber::Impl::listenToTransforms(ros::NodeHandle& nh,
                                                           const std::string& topic,
                                                           bool is_static) {
  // Not by tf2_ros::TransformListener, whose callback ends the process by such stamps.
  constexpr std::uint32_t kQueue = 100;
  return nh.subscribe<tf2_msgs::TFMessage>(
      topic, kQueue,
      boost::function<void(const tf2_msgs::TFMessageConstPtr&)>(
          [this, is_static](const tf2_msgs::TFMessageConstPtr& message) {
            acceptTransforms(*message, is_static);
          }),
      ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
}

MotionSubscriber::MotionSubscriber(const MotionConfig& config)
    : impl_(std::make_unique<Impl>(config)) {
  for (int i = 0; i < kSources; ++i) impl_->status[i].name = kNames[i];
}

MotionSubscriber::~MotionSubscriber() { unsubscribe(); }

void MotionSubscriber::subscribe(ros::NodeHandle nh) {
  unsubscribe();
  std::vector<ros::Subscriber> subscribers(kSources);
  subscribers[kImu] = impl_->listen<sensor_msgs::Imu>(nh, kImu);
  subscribers[kOdom] = impl_->listen<nav_msgs::Odometry>(nh, kOdom);
  subscribers[kGpsVel] = impl_->listen<geometry_msgs::TwistStamped>(nh, kGpsVel);
  subscribers[kGpsFix] = impl_->listen<sensor_msgs::NavSatFix>(nh, kGpsFix);
  subscribers[kMag] = impl_->listen<sensor_msgs::MagneticField>(nh, kMag);
  subscribers.push_back(impl_->listenToTransforms(nh, "/tf", false));
  subscribers.push_back(impl_->listenToTransforms(nh, "/tf_static", true));
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  for (int i = 0; i < kSources; ++i) impl_->status[i].topic = subscribers[i].getTopic();
  impl_->subscribers = std::move(subscribers);
  impl_->live = true;
}

void MotionSubscriber::unsubscribe() {
  std::vector<ros::Subscriber> subscribers;
  {
    const std::lock_guard<std::mutex> lock(impl_->mutex);
    subscribers.swap(impl_->subscribers);
    impl_->live = false;
  }
  // Outside the lock, since shutting down waits for callbacks, which take it.
  for (ros::Subscriber& subscriber : subscribers) subscriber.shutdown();
}

void MotionSubscriber::setConfig(const MotionConfig& config) {
  impl_->estimator.setConfig(config);
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  impl_->config = config;
  impl_->config.validate();
}

void MotionSubscriber::add(const sensor_msgs::Imu& message) { impl_->accept(kImu, message); }
void MotionSubscriber::add(const nav_msgs::Odometry& message) { impl_->accept(kOdom, message); }
void MotionSubscriber::add(const geometry_msgs::TwistStamped& message) {
  impl_->accept(kGpsVel, message);
}
void MotionSubscriber::add(const sensor_msgs::NavSatFix& message) {
  impl_->accept(kGpsFix, message);
}
void MotionSubscriber::add(const sensor_msgs::MagneticField& message) {
  impl_->accept(kMag, message);
}
void MotionSubscriber::add(const tf2_msgs::TFMessage& message, bool is_static) {
  impl_->acceptTransforms(message, is_static);
}

Motion MotionSubscriber::motionAt(const ros::Time& stamp, const std::string& left_optical_frame) {
  const MotionConfig config = impl_->currentConfig();
  std::string mounting_text = "no rates yet";
  // A mean over two time constants lags as much as the low-pass does that a fixed camera's rates
  // pass.
  const double interval = std::max(kShortestInterval, 2.0 * config.rate_filter_time);
  const MountingLookup mounting = [&](const std::string& frame, double time) {
    const auto found =
        lookUpMounting(impl_->tf, left_optical_frame, frame, time, interval, config.motion_timeout);
    mounting_text = !found ? "camera_rpy" : found->error.empty() ? "tf" : found->error;
    return found;
  };
  const auto motion_at = [&](double time) { return impl_->estimator.estimate(time, mounting); };

  MotionHistory history;
  {
    const std::lock_guard<std::mutex> lock(impl_->mutex);
    history = impl_->history;
  }
  Motion motion = history.ask(stamp.toSec(), motion_at);
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  impl_->history = history;
  impl_->mounting = mounting_text;
  return motion;
}

bool MotionSubscriber::ready(const ros::Time& stamp, const std::string& left_optical_frame) const {
  if (!impl_->estimator.ready(stamp.toSec())) return false;
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  if (impl_->await_transforms && !left_optical_frame.empty()) return false;
  return !impl_->transformIsDue(stamp, left_optical_frame);
}

bool MotionSubscriber::Impl::transformIsDue(const ros::Time& stamp,
                                            const std::string& optical_frame) const {
  std::string body = config.body_frame;
  if (body.empty()) {
    const bool odom = config.rate_source == "odom" || frames[kImu].empty();
    body = frames[odom ? kOdom : kImu];
  }
  const std::optional<ros::Time> newest = newestMounting(tf, optical_frame, body, stamp.toSec());
  if (!newest) return false;
  double period = 0.0;
  for (const auto& [name, frame] : moving_frames) {
    // The one that the others are ahead of.
    if (frame.newest == *newest) period = frame.stamps.period();
  }
  return isDue(secondsBetween(*newest, stamp), period, config.motion_timeout);
}

Motion MotionSubscriber::waitForMotion(const ros::Time& stamp,
                                       const std::string& left_optical_frame) {
  using Clock = std::chrono::steady_clock;
  const double limit = impl_->currentConfig().motion_wait;
  const auto end = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                      std::chrono::duration<double>(limit));
  while (!(ready(stamp, left_optical_frame) && firstMessagesAreHere()) && Clock::now() < end) {
    // The time limit covers what arrives between the question and the wait.
    std::unique_lock<std::mutex> lock(impl_->mutex);
    impl_->arrived.wait_until(lock, std::min(end, Clock::now() + std::chrono::milliseconds(2)));
  }
  if (Clock::now() >= end) giveUpOnFirstMessages();
  return motionAt(stamp, left_optical_frame);
}

bool MotionSubscriber::firstMessagesAreHere() const {
  std::vector<ros::Subscriber> silent;
  {
    const std::lock_guard<std::mutex> lock(impl_->mutex);
    if (impl_->gave_up || impl_->subscribers.empty()) return true;
    for (int source = 0; source < kSources; ++source) {
      if (impl_->status[source].received == 0) silent.push_back(impl_->subscribers[source]);
    }
  }
  // Outside the lock: roscpp answers only when it has told the master of what is being subscribed.
  return std::none_of(silent.begin(), silent.end(), [](const ros::Subscriber& subscriber) {
    return subscriber.getNumPublishers() > 0;
  });
}

void MotionSubscriber::giveUpOnFirstMessages() {
  impl_->estimator.awaitNoLonger();
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  impl_->gave_up = true;
  impl_->await_transforms = false;
}

void MotionSubscriber::startOver(const ros::Time& stamp) {
  impl_->estimator.startOver(stamp.toSec());
  std::deque<geometry_msgs::TransformStamped> ahead;
  {
    const std::lock_guard<std::mutex> lock(impl_->mutex);
    impl_->tf.clear();
    ahead.swap(impl_->ahead);
    impl_->await_transforms = !impl_->moving_frames.empty();
    impl_->moving_frames.clear();
    impl_->history.reset();
  }
  for (const auto& transform : ahead) impl_->acceptTransform(transform, false);
}

MotionInputStatus MotionSubscriber::status() const {
  const EstimatorReport report = impl_->estimator.report();
  const SourceReport* reports[kSources] = {&report.imu, &report.odom, &report.gps_vel,
                                           &report.gps_fix, &report.mag};
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  MotionInputStatus result;
  result.mounting = impl_->mounting;
  result.warning = report.warning;
  for (int i = 0; i < kSources; ++i) {
    MotionSourceStatus source = impl_->status[i];
    source.duplicates = reports[i]->counts.duplicates;
    source.out_of_order = reports[i]->counts.out_of_order + reports[i]->counts.too_late;
    source.gaps = reports[i]->counts.gaps;
    source.clock_jumps = reports[i]->counts.clock_jumps;
    source.last_stamp = reports[i]->last_stamp;
    source.rate = reports[i]->period > 0.0 ? 1.0 / reports[i]->period : 0.0;
    result.sources.push_back(source);
  }
  return result;
}

}  // namespace adaptive_grid_stereo
