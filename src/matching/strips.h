#ifndef ADAPTIVE_GRID_STEREO_SRC_MATCHING_STRIPS_H
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_STRIPS_H

#include <atomic>
#include <condition_variable>
#include <limits>
#include <mutex>
#include <vector>

#include "adaptive_grid_stereo/path_plan.h"
#include "src/matching/spin.h"
#include "src/matching/sweep.h"

namespace adaptive_grid_stereo {

/// How the threads share a sweep: each has a strip of columns in all bands, so that nearly all path
/// costs it reads are those it has written, which lie in its own caches. Only those on either side
/// of a border between strips go from one thread to another.
///
/// A thread may begin a band once its left neighbour has finished its strip there, and finish it
/// once its right neighbour has begun the band above: its paths reach so far and no farther.
class Strips {
 public:
  /// Steps after which what a left neighbour still needs of a band is there, and before the end of
  /// a strip from which on the right neighbour's part of the band above is needed: row 0 at step s
  /// reads the last row of the band above, which is kBandRows - 1 rows behind, up to kPathMargin
  /// ahead.
  static constexpr int kReach = kBandLag * (kBandRows - 1) + kPathMargin;

  /// At most `threads` strips of about the same work: that of a column grows with its paths. `plan`
  /// is as the sweep sees it. Starts the progress anew. Once `stop` is true, all strips end with
  /// the band that they are in.
  void assign(const PathPlan& plan, int threads, const std::atomic<bool>* stop);

  int count() const { return static_cast<int>(edges_.size()) - 1; }
  /// First step of a strip; that of count() is the end of the last one.
  int edge(int strip) const { return edges_[strip]; }
  const std::vector<int>& edges() const { return edges_; }

  /// Runs all bands of a strip: prepare(band), which must need nothing of other strips, then
  /// work(band, first step, end step) for one part of the steps after the other. Called by one
  /// thread per strip at the same time.
  template <class Prepare, class Work>
  void run(int strip, int bands, const Prepare& prepare, const Work& work) {
    const int begin = edge(strip), end = edge(strip + 1);
    for (int band = 0; band < bands && !*stop_; ++band) {
      prepare(band);
      if (count() == 1) {
        work(band, begin, end);
        continue;
      }
      if (strip > 0) wait(strip, strip - 1, finished(band));
      work(band, begin, begin + kReach);
      tell(strip, begun(band));
      work(band, begin + kReach, end - kReach);
      if (strip + 1 < count() && band > 0) wait(strip, strip + 1, begun(band - 1));
      work(band, end - kReach, end);
      tell(strip, finished(band));
    }
    tell(strip, std::numeric_limits<int>::max());  // nobody waits for what was stopped
  }

 private:
  static constexpr int kFewestSpins = 64;

  struct alignas(64) Progress {
    std::atomic<int> value{0};
    std::atomic<int> sleepers{0};  // who wait for the value
    // How long the strip's own thread spins before it sleeps: less where that was in vain.
    int spins = kMostSpins;
    std::mutex mutex;
    std::condition_variable changed;
  };

  static int begun(int band) { return 2 * band + 1; }
  static int finished(int band) { return 2 * band + 2; }
  void wait(int own, int other, int value);  // for the other strip to get there
  void tell(int strip, int value);

  std::vector<int> edges_;
  std::vector<Progress> progress_;
  std::vector<double> work_before_;  // each column
  const std::atomic<bool>* stop_ = nullptr;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_STRIPS_H
