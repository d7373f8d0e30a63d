#include "src/matching/thread_pool.h"

#include "src/matching/spin.h"

namespace adaptive_grid_stereo {

ThreadPool::ThreadPool(int size) {
  for (int index = 1; index < size; ++index) {
    workers_.emplace_back([this, index] { work(index); });
  }
}

ThreadPool::~ThreadPool() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stop_ = true;
  }
  start_.notify_all();
  for (std::thread& worker : workers_) worker.join();
}

void ThreadPool::run(const std::function<void(int)>& job) {
  if (workers_.empty()) return job(0);
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    job_ = &job;
    running_ = static_cast<int>(workers_.size());
    ++generation_;
  }
  start_.notify_all();
  job(0);
  const auto all_done = [this] { return running_ == 0; };
  if (spinUntil(all_done, kMostSpins)) return;
  std::unique_lock<std::mutex> lock(mutex_);
  done_.wait(lock, all_done);
}

void ThreadPool::work(int index) {
  unsigned seen = 0;
  const auto called = [&] { return stop_ || generation_ != seen; };
  for (;;) {
    if (!spinUntil(called, kMostSpins)) {
      std::unique_lock<std::mutex> lock(mutex_);
      start_.wait(lock, called);
    }
    if (stop_) return;
    seen = generation_;
    (*job_)(index);
    if (--running_ > 0) continue;
    // Under the lock, so that run() does not begin to wait in between.
    const std::lock_guard<std::mutex> lock(mutex_);
    done_.notify_one();
  }
}

}  // namespace adaptive_grid_stereo
