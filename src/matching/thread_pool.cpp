#include "src/matching/thread_pool.h"

#include "src/matching/spin.h"

namespace adaptive_grid_stereo {

ThreadPool::ThreadPool(int size) : parts_(size), caller_cpu_(kNoCpu), worker_cpu_(kNoCpu) {
  for (int own = 1; own < size; ++own) workers_.emplace_back([this, own] { work(own); });
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
  const std::uint32_t number = job_number_ + 1;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    job_ = &job;
    unfinished_ = size();
    caller_cpu_ = currentCpu();
    job_number_ = number;
  }
  start_.notify_all();
  doParts(number, 0);
  const auto all_done = [this] { return unfinished_ == 0; };
  if (spinUntil(all_done, sharesMyCpu(worker_cpu_) ? 0 : kMostSpins)) return;
  std::unique_lock<std::mutex> lock(mutex_);
  done_.wait(lock, all_done);
}

void ThreadPool::doParts(std::uint32_t job, int own) {
  for (int i = 0; i < size(); ++i) {
    const int part = (own + i) % size();
    std::uint32_t job_before = job - 1;
    if (!parts_[part].taken_in.compare_exchange_strong(job_before, job)) continue;
    (*job_)(part);
    if (--unfinished_ > 0) continue;
    // Under the lock, so that run() does not begin to wait in between.
    const std::lock_guard<std::mutex> lock(mutex_);
    done_.notify_one();
  }
}

void ThreadPool::work(int own) {
  std::uint32_t seen = 0;
  const auto called = [&] { return stop_ || job_number_ != seen; };
  for (;;) {
    if (!spinUntil(called, sharesMyCpu(caller_cpu_) ? 0 : kMostSpins)) {
      std::unique_lock<std::mutex> lock(mutex_);
      start_.wait(lock, called);
    }
    if (stop_) return;
    seen = job_number_;
    worker_cpu_ = currentCpu();
    doParts(seen, own);
  }
}

}  // namespace adaptive_grid_stereo
