#ifndef ADAPTIVE_GRID_STEREO_SRC_MATCHING_SPIN_H
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_SPIN_H

namespace adaptive_grid_stereo {

/// The longest that is worth it before sleeping, about 50 microseconds.
constexpr int kMostSpins = 4000;

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
