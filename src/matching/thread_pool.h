#ifndef ADAPTIVE_GRID_STEREO_SRC_MATCHING_THREAD_POOL_H
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_THREAD_POOL_H

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace adaptive_grid_stereo {

/// A fixed team of threads that run one job together. The sweeps' threads wait for each other, so
/// all of them must run at once: cv::parallel_for_ does not promise that.
class ThreadPool {
 public:
  /// `size` >= 1 threads, the caller of run() included.
  explicit ThreadPool(int size);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  int size() const { return static_cast<int>(workers_.size()) + 1; }

  /// Runs job(0) .. job(size - 1), each on its own thread, and returns when all are done. The job
  /// must not throw. Not reentrant. Threads that have finished keep spinning for some microseconds,
  /// since one job of a frame follows the other; waking them up would take longer than some jobs
  /// do.
  void run(const std::function<void(int)>& job);

 private:
  void work(int index);

  std::vector<std::thread> workers_;
  std::mutex mutex_;  // of the waits; what they wait for changes under it
  std::condition_variable start_, done_;
  const std::function<void(int)>* job_ = nullptr;
  std::atomic<unsigned> generation_{0};
  std::atomic<int> running_{0};
  std::atomic<bool> stop_{false};
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_THREAD_POOL_H
