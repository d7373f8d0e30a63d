#ifndef ADAPTIVE_GRID_STEREO_GUIDANCE_SAMPLE_BUFFER_H
#define ADAPTIVE_GRID_STEREO_GUIDANCE_SAMPLE_BUFFER_H

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <utility>
#include <vector>

namespace adaptive_grid_stereo {

/// What has happened to the stamps of one source.
struct StampCounts {
  std::uint64_t accepted = 0;
  std::uint64_t duplicates = 0;    // same stamp again: refused
  std::uint64_t out_of_order = 0;  // older than the newest: sorted in
  std::uint64_t too_late = 0;      // older than all that is kept: refused
  std::uint64_t gaps = 0;          // longer than the limit of the buffer
  std::uint64_t clock_jumps = 0;   // backwards
};

/// Samples at most so far apart are joined by a straight line [s]; otherwise the earlier one holds
/// until the later one comes. A live node can afford to wait so long for the later one.
constexpr double kInterpolationReach = 0.025;

/// Whether it is worth while to wait for the next sample of a source, whose newest one lies
/// `missing` [s] before the stamp that is asked for; period [s]: 0 if unknown. A silent source is
/// not waited for; a fast one until its next sample, which the interpolation wants; a slow one only
/// if a sample is due. The first samples do not tell yet which it is.
inline bool isDue(double missing, double period, double timeout) {
  if (missing <= 0.0 || missing > timeout) return false;
  return period <= 1.5 * kInterpolationReach || missing >= 0.8 * period;
}

/// The newest samples of one source, sorted by stamp. Sample has a member `stamp` [s].
///
/// Stragglers are sorted in. Three samples in a row that lie more than kClockJump behind the newest
/// one mean that the clock was set back (a bag that loops), or that the newest one was stamped far
/// in the future: in both cases everything later than they is dropped. startOver() is for those who
/// learn of such a jump elsewhere, before or after the samples show it. Not thread safe.
template <typename Sample>
class SampleBuffer {
 public:
  static constexpr double kClockJump = 2.0;  // [s]
  /// Samples that arrive with a stamp so far before that of the one before begin a new run [s].
  static constexpr double kStepBack = 0.5;
  static constexpr double kNothing = std::numeric_limits<double>::infinity();

  explicit SampleBuffer(std::size_t capacity) : capacity_(capacity) {}

  /// Puts a sample in its place. Returns the stamp from which on the contents have changed,
  /// kNothing if they have not. gap_limit [s]: what counts as a gap.
  double insert(Sample sample, double gap_limit) {
    const double stamp = sample.stamp;
    if (last_arrived_ - stamp > kStepBack) {
      ++run_;
      run_begin_ = stamp;
    }
    last_arrived_ = stamp;
    awaited_ = false;
    if (samples_.empty() || stamp > back().stamp) {
      behind_ = 0;
      if (!samples_.empty() && stamp - back().stamp > gap_limit) ++counts_.gaps;
      samples_.push_back({std::move(sample), run_});
      ++counts_.accepted;
      if (samples_.size() > capacity_) samples_.pop_front();
      return stamp;
    }
    const bool far_behind = back().stamp - stamp > kClockJump;
    behind_ = far_behind ? behind_ + 1 : 0;
    const double changed_from = insertBetween(std::move(sample), far_behind);
    if (behind_ < 3) return changed_from;
    behind_ = 0;
    ++counts_.clock_jumps;
    samples_.erase(samples_.begin() + count(stamp), samples_.end());
    return stamp;
  }

  /// Number of samples with a stamp up to `time` [s].
  std::size_t count(double time) const {
    const auto later = [](double value, const Kept& kept) { return value < kept.sample.stamp; };
    return std::upper_bound(samples_.begin(), samples_.end(), time, later) - samples_.begin();
  }

  /// The latest sample with a stamp up to `time` [s]; null if there is none.
  const Sample* latest(double time) const {
    const std::size_t n = count(time);
    return n > 0 ? &samples_[n - 1].sample : nullptr;
  }

  /// Median interval of the latest samples [s]; 0 with fewer than three.
  double period() const {
    constexpr std::size_t kIntervals = 16;
    if (samples_.size() < 3) return 0.0;
    const std::size_t n = std::min(kIntervals, samples_.size() - 1);
    std::vector<double> intervals(n);
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t last = samples_.size() - 1 - i;
      intervals[i] = (*this)[last].stamp - (*this)[last - 1].stamp;
    }
    std::nth_element(intervals.begin(), intervals.begin() + n / 2, intervals.end());
    return intervals[n / 2];
  }

  bool empty() const { return samples_.empty(); }
  std::size_t size() const { return samples_.size(); }
  const Sample& operator[](std::size_t index) const { return samples_[index].sample; }
  const Sample& back() const { return samples_.back().sample; }
  const StampCounts& counts() const { return counts_; }

  /// Time starts over at about `stamp` [s]. What has arrived since the samples' own stamps stepped
  /// back stays, all before is forgotten; if they have not got there yet, everything is, and the
  /// source is awaited.
  void startOver(double stamp) {
    behind_ = 0;
    const bool stepped_back = run_ != known_run_ && run_begin_ - stamp <= kStepBack;
    known_run_ = run_;
    if (!stepped_back && last_arrived_ - stamp > kStepBack) {
      awaited_ = awaited_ || !samples_.empty();
      samples_.clear();
      return;
    }
    const auto of_old_run = [this](const Kept& kept) { return kept.run != run_; };
    samples_.erase(std::remove_if(samples_.begin(), samples_.end(), of_old_run), samples_.end());
  }

  /// Whether the source has delivered before time started over, and not since.
  bool awaited() const { return awaited_; }
  void awaitNoLonger() { awaited_ = false; }

 private:
  struct Kept {
    Sample sample;
    std::uint32_t run;
  };

  double insertBetween(Sample sample, bool far_behind) {
    const double stamp = sample.stamp;
    const auto place = samples_.begin() + count(stamp);
    if (place != samples_.begin() && (place - 1)->sample.stamp == stamp) {
      if (far_behind && (place - 1)->run != run_) {
        *(place - 1) = {std::move(sample), run_};
        ++counts_.accepted;
        return stamp;
      }
      ++counts_.duplicates;
      return kNothing;
    }
    if (place == samples_.begin() && samples_.size() >= capacity_ && !far_behind) {
      ++counts_.too_late;
      return kNothing;
    }
    if (!far_behind) ++counts_.out_of_order;
    ++counts_.accepted;
    samples_.insert(place, {std::move(sample), run_});
    if (samples_.size() > capacity_ && !far_behind) samples_.pop_front();
    return stamp;
  }

  std::size_t capacity_;
  std::deque<Kept> samples_;
  StampCounts counts_;
  int behind_ = 0;
  double last_arrived_ = -kNothing;
  std::uint32_t run_ = 0, known_run_ = 0;  // the latest, and that of the last startOver()
  double run_begin_ = 0.0;
  bool awaited_ = false;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_GUIDANCE_SAMPLE_BUFFER_H
