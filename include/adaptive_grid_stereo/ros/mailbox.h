#ifndef ADAPTIVE_GRID_STEREO_ROS_MAILBOX_H
#define ADAPTIVE_GRID_STEREO_ROS_MAILBOX_H

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <utility>

namespace adaptive_grid_stereo {

/// Hands frames from the callbacks to the worker. With kNewest an item that was not fetched is
/// replaced by the next one; with kEvery all are kept in order. Thread safe.
template <typename T>
class Mailbox {
 public:
  enum class Mode { kNewest, kEvery };

  explicit Mailbox(Mode mode) : mode_(mode) {}

  /// Returns the number of items that were replaced (0 or 1).
  std::size_t put(T item) {
    std::size_t replaced = 0;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (stopped_) return 0;
      if (mode_ == Mode::kNewest) {
        replaced = items_.size();
        items_.clear();
      }
      items_.push_back(std::move(item));
    }
    filled_.notify_one();
    return replaced;
  }

  /// Waits for an item; false once the mailbox is stopped.
  bool take(T& item) {
    std::unique_lock<std::mutex> lock(mutex_);
    filled_.wait(lock, [this] { return stopped_ || !items_.empty(); });
    if (stopped_) return false;
    item = std::move(items_.front());
    items_.pop_front();
    return true;
  }

  /// Throws away what was not fetched; returns how many.
  std::size_t clear() {
    const std::lock_guard<std::mutex> lock(mutex_);
    const std::size_t count = items_.size();
    items_.clear();
    return count;
  }

  std::size_t size() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return items_.size();
  }

  /// Wakes the worker up for good; what was not fetched is lost.
  void stop() {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      stopped_ = true;
      items_.clear();
    }
    filled_.notify_all();
  }

 private:
  const Mode mode_;
  mutable std::mutex mutex_;
  std::condition_variable filled_;
  std::deque<T> items_;
  bool stopped_ = false;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_ROS_MAILBOX_H
