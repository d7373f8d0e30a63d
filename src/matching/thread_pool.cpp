#include "src/matching/thread_pool.h"

#include "src/matching/spin.h"

namespace adaptive_grid_stereo {
namespace {

constexpr int kPartBits = 32;

std::uint32_t generationOf(std::uint64_t next) {
  return static_cast<std::uint32_t>(next >> kPartBits);
}

}  // namespace

ThreadPool::ThreadPool(int size) : caller_cpu_(kNoCpu), worker_cpu_(kNoCpu) {
  for (int index = 1; index < size; ++index) workers_.emplace_back([this] { work(); });
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
  const std::uint32_t generation = generationOf(next_) + 1;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    job_ = &job;
    unfinished_ = size();
    caller_cpu_ = currentCpu();
    next_ = static_cast<std::uint64_t>(generation) << kPartBits;
  }
  start_.notify_all();
  doParts(generation);
  const auto all_done = [this] { return unfinished_ == 0; };
  if (spinUntil(all_done, sharesMyCpu(worker_cpu_) ? 0 : kMostSpins)) return;
  std::unique_lock<std::mutex> lock(mutex_);
  done_.wait(lock, all_done);
}

bool ThreadPool::takePart(std::uint32_t generation, int* part) {
  std::uint64_t next = next_;
  do {
    *part = static_cast<int>(next & ((std::uint64_t{1} << kPartBits) - 1));
    if (generationOf(next) != generation || *part == size()) return false;
  } while (!next_.compare_exchange_weak(next, next + 1));
  return true;
}

void ThreadPool::doParts(std::uint32_t generation) {
  int part;
  while (takePart(generation, &part)) {
    (*job_)(part);
    if (--unfinished_ > 0) continue;
    // Under the lock, so that run() does not begin to wait in between.
    const std::lock_guard<std::mutex> lock(mutex_);
    done_.notify_one();
  }
}

void ThreadPool::work() {
  std::uint32_t seen = 0;
  const auto called = [&] { return stop_ || generationOf(next_) != seen; };
  for (;;) {
    if (!spinUntil(called, sharesMyCpu(caller_cpu_) ? 0 : kMostSpins)) {
      std::unique_lock<std::mutex> lock(mutex_);
      start_.wait(lock, called);
    }
    if (stop_) return;
    seen = generationOf(next_);
    worker_cpu_ = currentCpu();
    doParts(seen);
  }
}

}  // namespace adaptive_grid_stereo
