#ifndef ADAPTIVE_GRID_STEREO_SRC_MATCHING_PATIENCE_H
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_PATIENCE_H

#include <chrono>
#include <thread>

namespace adaptive_grid_stereo {

/// Waiting for another thread that should be ready within microseconds: spins first, then sleeps.
///
/// It does not yield in between: two threads that yield to each other on one core look busy and
/// recently run to the scheduler, which then may leave them there while another core is idle. One
/// that sleeps wakes up on an idle core.
class Patience {
 public:
  /// Lets a little time pass.
  void pause() {
    if (is_over_) return std::this_thread::sleep_for(std::chrono::microseconds(20));
    for (int i = 0; i < kSpinsPerLook; ++i) relax();
    const Clock::time_point now = Clock::now();
    if (begin_ == Clock::time_point()) begin_ = now;
    is_over_ = now - begin_ > std::chrono::microseconds(100);
  }

  /// Whether it has spun long enough: from now on it sleeps.
  bool isOver() const { return is_over_; }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr int kSpinsPerLook = 4;

  /// Tells the core that this is a loop of waiting.
  static void relax() {
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#elif defined(__aarch64__)
    asm volatile("yield");
#endif
  }

  Clock::time_point begin_;
  bool is_over_ = false;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_PATIENCE_H
