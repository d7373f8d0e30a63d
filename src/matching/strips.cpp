#include "src/matching/strips.h"

#include <algorithm>

namespace adaptive_grid_stereo {
namespace {

/// What is done once per pixel, in units of one path's work; measured.
constexpr double kFixedWork = 14.0;

/// Narrower strips spend too much of their time on waiting for each other [px].
constexpr int kNarrowest = 64;
static_assert(kNarrowest > 2 * Strips::kReach, "both ends of a strip must fit");

/// Mean work per pixel of each column of cells.
double workOf(const PathPlan& plan, int column) {
  double work = 0.0;
  for (int row = 0; row < 3; ++row) {
    work += (kFixedWork + plan.paths[3 * row + column]) *
            (plan.row_edges[row + 1] - plan.row_edges[row]);
  }
  return work;
}

}  // namespace

void Strips::assign(const PathPlan& plan, int threads, const std::atomic<bool>* stop) {
  stop_ = stop;
  const int width = plan.column_edges[3];
  const int count = std::clamp(width / kNarrowest, 1, threads);
  work_before_.assign(width + 1, 0.0);
  for (int column = 0; column < 3; ++column) {
    const double work = workOf(plan, column);
    for (int u = plan.column_edges[column]; u < plan.column_edges[column + 1]; ++u) {
      work_before_[u + 1] = work_before_[u] + work;
    }
  }
  // A band's rows lag behind each other, so the edges lie half a band's lag farther.
  constexpr int kLag = kBandLag * (kBandRows - 1);
  edges_.assign(1, -kPathMargin);
  for (int strip = 1; strip < count; ++strip) {
    const double share = work_before_[width] * strip / count;
    const auto place = std::lower_bound(work_before_.begin(), work_before_.end(), share);
    const int step = static_cast<int>(place - work_before_.begin()) + kLag / 2;
    edges_.push_back(
        std::clamp(step, edges_.back() + kNarrowest / 2, width - (count - strip) * kNarrowest / 2));
  }
  edges_.push_back(width + kPathMargin + kLag);
  if (static_cast<int>(progress_.size()) != count) progress_ = std::vector<Progress>(count);
  for (Progress& progress : progress_) progress.value = 0;
}

void Strips::tell(int strip, int value) {
  Progress& progress = progress_[strip];
  progress.value = value;
  // Either this sees that somebody sleeps, or that one sees the value before it falls asleep.
  if (progress.sleepers == 0) return;
  { const std::lock_guard<std::mutex> lock(progress.mutex); }
  progress.changed.notify_all();
}

void Strips::wait(int own, int other, int value) {
  Progress& progress = progress_[other];
  const auto reached = [&] { return progress.value >= value; };
  int& spins = progress_[own].spins;
  if (spinUntil(reached, spins)) {
    spins = std::min(2 * spins, kMostSpins);
    return;
  }
  spins = std::max(spins / 2, kFewestSpins);
  std::unique_lock<std::mutex> lock(progress.mutex);
  ++progress.sleepers;
  progress.changed.wait(lock, reached);
  --progress.sleepers;
}

}  // namespace adaptive_grid_stereo
