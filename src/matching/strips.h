#ifndef ADAPTIVE_GRID_STEREO_SRC_MATCHING_STRIPS_H
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_STRIPS_H

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <limits>
#include <mutex>
#include <utility>
#include <vector>

#include "adaptive_grid_stereo/path_plan.h"
#include "src/matching/bands.h"
#include "src/matching/spin.h"
#include "src/matching/sweep.h"

namespace adaptive_grid_stereo {

/// How the threads share the sweeps.
///
/// Half of them do the downward sweep, the others the upward one, at the same time. These have
/// nothing to do with each other until they meet, wherever that is: a band's first pass is that of
/// the sweep that comes there first. (One thread does the whole downward sweep before the other.)
///
/// The threads of one sweep have a strip of columns each, in all bands, so that nearly all path
/// costs that one reads are those it has written, which lie in its own caches. Only those on either
/// side of a border between strips go from one thread to another. A thread that has a sweep by
/// itself takes both of its strips as one, until another one that is out of work wants the second.
///
/// Where the sweeps of two threads meet, the threads change over: each goes on with the other's
/// sweep, back over the rows that it comes from. So it reads the volume that it has written itself,
/// and the faster one of two unlike cores, which has come farther, has more of the second pass,
/// too.
///
/// A band of a strip can begin once its left neighbour has finished its strip there (the first
/// strip if the other sweep has not begun with the band, or has finished it), and can be finished
/// once its right neighbour has begun the band above: its paths reach so far and no farther. Of the
/// strips that are not finished one can always go on.
///
/// Whoever has to wait for a strip that nobody works on takes it over, so a thread that gets no
/// core is not waited for; only one that loses its core in the midst of a stage is.
class Strips {
 public:
  /// Steps after which what a left neighbour still needs of a band is there, and before the end of
  /// a strip from which on the right neighbour's part of the band above is needed: row 0 at step s
  /// reads the last row of the band above, which is kBandRows - 1 rows behind, up to kPathMargin
  /// ahead.
  static constexpr int kReach = kLargestLag + kPathMargin;

  /// A band of one of the strips.
  struct Part {
    int strip;         // of both sweeps': first those of the downward one
    int buffers;       // the strip whose buffers it uses: itself, or one of the other sweep's
    int sweep;         // kDown or kUp
    int band;          // along the sweep
    int begin, end;    // the strip's steps, or its joined neighbour's, too
    bool second_pass;  // whether the other sweep has been there
    BandTurns turns;
  };

  /// As many strips per sweep as `threads` make, and about the same work in all: that of a column
  /// grows with its paths. Starts the progress anew. Once `stop` is true, all strips end with the
  /// band that they are in.
  void assign(const PathPlan& plan, int threads, const std::atomic<bool>* stop);

  /// Strips of each sweep for so many threads, if the image is wide enough.
  /// (Two threads have a sweep each, and help each other in the end.)
  static int perSweep(int threads) { return threads == 2 ? 2 : (threads + 1) / 2; }

  /// Bands of one sweep that may be in work, or finished by not all strips, at the same time.
  static constexpr int kOpenBands = 3;

  /// First steps of a sweep's strips, and the end of the last one.
  const std::vector<int>& edges(int sweep) const { return edges_[sweep]; }
  /// Strips of all sweeps.
  int count() const { return static_cast<int>(strips_.size()); }

  /// Works on strips until all are finished, or are in the hands of others; each of the threads
  /// 0 .. threads - 1 begins with its own. prepare(part) must need nothing of other strips;
  /// work(part, first step, end step) does one piece of the part's steps after the other. No two
  /// threads work on a strip at the same time. Called by any number of threads.
  template <class Prepare, class Work>
  void run(int thread, const Prepare& prepare, const Work& work) {
    int own = thread * count() / std::min(threads_, count());
    // Where to change over to, as long as this thread has not.
    int across = threads_ == 2 ? firstOf(1 - sweepOf(own)) : kNobody;
    for (int strip; (strip = take(&own)) >= 0;) {
      if (across != kNobody && sweepOf(strip) == sweepOf(across)) across = kNobody;
      bool changes_over;
      do {
        changes_over = across != kNobody && !isFinished(across) && meetsOtherSweep(strip);
        if (!changes_over) runStage(strip, prepare, work);
      } while (!changes_over && (canGoOn(strip) || waitInHand(strip)));
      leave(strip);
      if (!changes_over) continue;
      own = std::exchange(across, kNobody);
      // The other thread leaves it within a moment; if it does not, take() finds what there is.
      spinUntil([&] { return isFree(own); }, kMostSpins);
    }
  }

 private:
  static constexpr int kFewestSpins = 64;
  // A band's stages: up to kReach, from there to kReach before the end, the rest.
  static constexpr int kStages = 3;

  struct alignas(64) Strip {
    std::atomic<int> stage{0};  // the next one, of all bands
    std::atomic<bool> taken{false};
    std::atomic<bool> joined{false};  // and taken together with its neighbour
    std::atomic<bool> wanted{false};  // by a thread that has nothing else to do
    std::atomic<int> cpu{kNoCpu};     // of the thread that has taken it
    // How long that thread spins for a neighbour: less where that was in vain.
    std::atomic<int> spins{kMostSpins};
    // Of threads that sleep: how many, and the lowest stage that one of them waits for.
    std::atomic<int> sleepers{0}, awaited{kNever};
    std::mutex mutex;
    std::condition_variable changed;
  };

  static constexpr int kNever = std::numeric_limits<int>::max();
  static constexpr int kNobody = -1;

  // A stage that a strip must have got to before another one can go on; kNever: until it is left.
  struct Need {
    int strip, stage;
  };

  template <class Prepare, class Work>
  void runStage(int strip, const Prepare& prepare, const Work& work) {
    const int stage = strips_[strip].stage, band = stage / kStages;
    strips_[strip].cpu = currentCpu();
    bool whole = false;
    if (stage % kStages == 0) {
      if (*stop_) return reach(strip, kStages * bands_.count());
      // The other sweep may have begun with the band just now.
      if (!claim(strip, band) && !canGoOn(strip)) return;
      whole = perSweep() == 1 || tryToJoin(strip, stage);
      takeTurn(strip, band, whole);
    }
    Part part = partOf(strip, band);
    const int begin = part.begin, end = part.end;
    if (whole) {
      part.end = edges(part.sweep).back();
      prepare(part);
      work(part, begin, part.end);
      reach(strip, stage + kStages);
      if (perSweep() > 1) release(strip + 1, stage + kStages);
      return;
    }
    switch (stage % kStages) {
      case 0:
        prepare(part);
        work(part, begin, begin + kReach);
        break;
      case 1:
        work(part, begin + kReach, end - kReach);
        break;
      case 2:
        work(part, end - kReach, end);
        break;
    }
    reach(strip, stage + 1);
  }

  // Strips of each sweep.
  int perSweep() const { return static_cast<int>(edges_[0].size()) - 1; }
  int sweepOf(int strip) const { return strip / perSweep(); }
  int firstOf(int sweep) const { return sweep * perSweep(); }
  // The edges of so many strips of about the same work.
  std::vector<int> divide(const PathPlan& plan, int count);
  Part partOf(int strip, int band) const;
  // Of a band's rows, whatever the sweep.
  int claimPlace(int sweep, int band) const {
    return sweep == kDown ? band : bands_.opposite(band);
  }
  // Whether the other sweep has claimed a band's first pass.
  bool isOfOtherSweep(int sweep, int band) const {
    return claims_[claimPlace(sweep, band)] == 1 - sweep;
  }
  // Of a band (BandTurns), or of none, above the first one.
  int turnOf(int sweep, int band) const { return band < 0 ? 0 : turns_[sweep][band]; }
  // Sets a band's turn, if this is its sweep's first strip, which begins with it or takes the
  // whole.
  void takeTurn(int strip, int band, bool whole);
  // Claims a band's first pass for a strip's sweep; whether it has it.
  bool claim(int strip, int band);
  Need needOf(int strip) const;
  bool isMet(const Need& need) const { return strips_[need.strip].stage >= need.stage; }
  // Whether it is met, or nobody works on it any more.
  bool hasChanged(const Need& need) const { return isMet(need) || !strips_[need.strip].taken; }
  bool isFinished(int strip) const { return strips_[strip].stage >= kStages * bands_.count(); }
  bool canGoOn(int strip) const;
  bool isFree(int strip) const { return !strips_[strip].taken && canGoOn(strip); }
  // Whether a strip can go on, and the other sweep has finished the band that comes next.
  bool meetsOtherSweep(int strip) const;
  bool tryToTake(int strip);
  // Takes the other one of two strips, too, if it has come as far and nobody wants it.
  bool tryToJoin(int strip, int stage);
  // Leaves a strip that was joined, finished up to a stage.
  void release(int strip, int stage);
  // Takes a strip that can go on, `own` rather than another; waits for one where that makes sense.
  // Negative if there is no more to do for this thread. Where its own strip is finished, or in the
  // hands of another thread, it gets one that was joined to its neighbour.
  int take(int* own);
  // A strip that is joined to its neighbour, the first one from `own` on; negative if there is
  // none.
  int findJoined(int own) const;
  void leave(int strip);
  void reach(int strip, int stage);
  // Whether what a strip in hand needs comes within a short wait.
  bool waitInHand(int strip);
  // The strip in somebody's hand that `strip` waits for in the end, or `strip` itself and its next
  // stage; a stage of 0 if there is none.
  Need findHolder(int strip) const;
  void sleepFor(const Need& need);

  std::vector<int> edges_[kSweeps];
  std::vector<Strip> strips_;
  // The sweep that has a band's first pass, or kNobody, [claimPlace()].
  std::vector<std::atomic<int>> claims_;
  std::vector<int> turns_[kSweeps];  // [band], see BandTurns
  std::vector<double> work_before_;  // each column
  const std::atomic<bool>* stop_ = nullptr;
  Bands bands_;  // downwards
  int threads_ = 1;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_STRIPS_H
