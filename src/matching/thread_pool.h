#ifndef ADAPTIVE_GRID_STEREO_SRC_MATCHING_THREAD_POOL_H
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_THREAD_POOL_H

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace adaptive_grid_stereo {

/// A fixed team of threads that share the parts of a job. If one gets no core, because other
/// programs keep them busy or the system has put it onto that of the caller, the others do its
/// parts. cv::parallel_for_ would do so too, but has one team for the whole process, whose size is
/// not ours to set.
class ThreadPool {
 public:
  /// `size` >= 1 threads, the caller of run() included.
  explicit ThreadPool(int size);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  int size() const { return static_cast<int>(workers_.size()) + 1; }

  /// Runs job(0) .. job(size - 1), each once, several at the same time where there are cores for
  /// them, and returns when all are done. Part 0 is the caller's, and each of the others the same
  /// thread's in every job, so that it finds in its caches what it had there before; but who has
  /// nothing else to do takes what has not been begun. The job must not throw. Not reentrant.
  /// Threads that have finished keep spinning for some microseconds, since one job of a frame
  /// follows the other; waking them up would take longer than some jobs do.
  void run(const std::function<void(int)>& job);

 private:
  void work(int own);
  // Does the thread's own part of a job, and any that nobody has begun.
  void doParts(std::uint32_t job, int own);

  std::vector<std::thread> workers_;
  std::mutex mutex_;  // of the waits; what they wait for changes under it
  std::condition_variable start_, done_;
  const std::function<void(int)>* job_ = nullptr;  // while there are unfinished parts
  std::atomic<std::uint32_t> job_number_{0};
  // The last job that each part was taken in. It is taken from the job before, so a late thread
  // takes none of the next job.
  struct alignas(64) Part {
    std::atomic<std::uint32_t> taken_in{0};
  };
  std::vector<Part> parts_;
  std::atomic<int> unfinished_{0};
  std::atomic<int> caller_cpu_;
  std::atomic<int> worker_cpu_;  // of the worker that came to a job last
  std::atomic<bool> stop_{false};
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_THREAD_POOL_H
