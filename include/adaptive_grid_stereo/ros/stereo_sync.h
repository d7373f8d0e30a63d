#ifndef ADAPTIVE_GRID_STEREO_ROS_STEREO_SYNC_H
#define ADAPTIVE_GRID_STEREO_ROS_STEREO_SYNC_H

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include <ros/node_handle.h>

#include "adaptive_grid_stereo/ros/input_check.h"
#include "adaptive_grid_stereo/ros/stereo_pair.h"

namespace adaptive_grid_stereo {

struct SyncOptions {
  bool approximate = false;
  /// Largest difference of the stamps of a pair [s], approximate only; 0: no limit.
  double max_interval = 0.0;
  /// Messages kept per input while waiting for their partners.
  int queue_size = 5;
  /// Transport of both images.
  std::string image_transport = "raw";
};

/// What has come in on one of the four inputs.
struct InputStatus {
  std::string topic;           // resolved
  std::uint64_t received = 0;  // messages since the node started
  double rate = 0.0;           // [Hz], over the last seconds
  double silence = 0.0;        // since the last message, or since subscribing [s]
  double newest_stamp = 0.0;   // [s]
  /// From the left images' stamps to this input's, where they come nearest to each other [s]; 0
  /// while pairs come.
  double offset = 0.0;
  std::uint32_t publishers = 0;  // now
};

struct SyncStatus {
  bool subscribed = false;
  bool approximate = false;
  /// Left image, right image, left info, right info.
  std::array<InputStatus, 4> inputs;
  std::uint64_t pairs = 0;
  /// Left images that found no partners.
  std::uint64_t unmatched = 0;
  /// Pairs dropped because their stamp was not newer than the last one's.
  std::uint64_t out_of_order = 0;
  /// Of these, since the last pair that was not dropped.
  std::uint64_t repeated = 0;
  /// Times that stamps jumped back and the synchronisation started anew.
  std::uint64_t clock_jumps = 0;
  /// Of these, in the last kJumpMemory seconds.
  std::uint64_t jumps_lately = 0;
  double pair_rate = 0.0;             // [Hz]
  double silence = 0.0;               // since the last pair, or since subscribing [s]
  double max_stamp_difference = 0.0;  // |left - right| of the pairs [s]
};

/// In words what keeps pairs from coming, with the cure; empty while they come, or while nobody
/// listens.
std::string syncAdvice(const SyncStatus& status);

/// In words, with the cure, that stamps jump too often for a recording that loops; empty if they do
/// not.
std::string jumpAdvice(const SyncStatus& status);

/// Pairs left image, right image and their camera_infos by stamp. Subscribes on demand. Starts anew
/// when stamps jump back (a recording that loops), drops pairs that come twice or late, and says in
/// the log what is wrong after kPatience seconds without a pair.
///
/// Everything happens in the callback queue of the node handle, which must be single-threaded; call
/// the functions from there too, or while no callback runs.
class StereoSync {
 public:
  using PairCallback = std::function<void(const StereoPair&)>;
  using JumpCallback = std::function<void(const ros::Time&)>;
  /// Seconds of silence before advice is given.
  static constexpr double kPatience = 5.0;
  /// Seconds for which a jump of the stamps counts in SyncStatus::jumps_lately.
  static constexpr double kJumpMemory = 10.0;

  /// on_pair: every pair, stamps increasing; on_jump: stamps start over at about the
  /// one given, before the next pair.
  StereoSync(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle,
             const SyncOptions& options, PairCallback on_pair, JumpCallback on_jump);
  ~StereoSync();

  void subscribe();
  void unsubscribe();

  /// Resolved names of the inputs.
  const InputTopics& topics() const;

  SyncStatus status() const;
  /// SyncStatus::out_of_order alone, without asking roscpp for publishers.
  std::uint64_t outOfOrder() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_ROS_STEREO_SYNC_H
