#ifndef ADAPTIVE_GRID_STEREO_SRC_MATCHING_SPIN_H
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_SPIN_H

#ifdef __linux__
#include <sched.h>
#endif

namespace adaptive_grid_stereo {

/// The longest that is worth it before sleeping, about 50 microseconds.
constexpr int kMostSpins = 4000;

/// No core: of a thread that runs on none, or where the system does not tell.
constexpr int kNoCpu = -1;

/// The core that the calling thread runs on, or kNoCpu.
inline int currentCpu() {
#ifdef __linux__
  return sched_getcpu();
#else
  return kNoCpu;
#endif
}

/// Whether a thread that was last seen on core `cpu` cannot go on while the calling thread runs.
inline bool sharesMyCpu(int cpu) { return cpu != kNoCpu && cpu == currentCpu(); }

/// Looks up to `spins` times whether ready(), some microseconds per thousand; returns whether it
/// is.
///
/// For waits that are short as a rule. Who is not served by then must sleep until it is woken:
/// where other programs keep the cores busy, the thread waited for may need the very core that this
/// one spins on, and one that yields may hand it to those other programs for milliseconds.
template <class Ready>
bool spinUntil(const Ready& ready, int spins) {
  for (int i = 0; i < spins; ++i) {
    if (ready()) return true;
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#elif defined(__aarch64__)
    asm volatile("yield");
#endif
  }
  return ready();
}

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_SPIN_H
