#include "src/matching/strips.h"

#include <algorithm>

#include "src/matching/pixel_kinds.h"

namespace adaptive_grid_stereo {
namespace {

/// What is done once per pixel, in units of one path's work. With AVX-512 and 64 disparities about
/// 4 was measured on an Intel Xeon, and more on an AMD EPYC, whose paths are cheaper beside the
/// rest.
constexpr double kFixedWork = 6.0;

/// Narrower strips spend too much of their time on waiting for each other [px].
constexpr int kNarrowest = 64;
static_assert(kNarrowest / 2 > 2 * Strips::kReach, "both ends of a strip must fit");

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

std::vector<int> Strips::divide(const PathPlan& plan, int count) {
  const int width = plan.column_edges[3];
  work_before_.assign(width + 1, 0.0);
  for (int column = 0; column < 3; ++column) {
    const double work = workOf(plan, column);
    for (int u = plan.column_edges[column]; u < plan.column_edges[column + 1]; ++u) {
      work_before_[u + 1] = work_before_[u] + work;
    }
  }
  // A band's rows lag behind each other, so the edges lie half a band's lag farther.
  std::vector<int> edges(1, 0);
  for (int strip = 1; strip < count; ++strip) {
    const double share = work_before_[width] * strip / count;
    const auto place = std::lower_bound(work_before_.begin(), work_before_.end(), share);
    const int step = static_cast<int>(place - work_before_.begin()) + kLargestLag / 2;
    edges.push_back(
        std::clamp(step, edges.back() + kNarrowest / 2, width - (count - strip) * kNarrowest / 2));
  }
  edges.push_back(width + kLargestLag);
  return edges;
}

void Strips::assign(const PathPlan& plan, int threads, const std::atomic<bool>* stop) {
  stop_ = stop;
  threads_ = threads;
  bands_ = Bands(plan.row_edges[3], false);
  const int per_sweep = std::clamp(plan.column_edges[3] / kNarrowest, 1, perSweep(threads));
  edges_[kDown] = divide(plan, per_sweep);
  edges_[kUp] = divide(turned(plan), per_sweep);
  const std::size_t count = static_cast<std::size_t>(kSweeps) * per_sweep;
  if (strips_.size() != count) strips_ = std::vector<Strip>(count);
  for (Strip& strip : strips_) {
    strip.stage = 0;
    strip.awaited = kNever;
    strip.wanted = false;
  }
  const std::size_t bands = bands_.count();
  if (claims_.size() != bands) claims_ = std::vector<std::atomic<int>>(bands);
  for (std::atomic<int>& claim : claims_) claim = kNobody;
  for (std::vector<int>& turns : turns_) turns.resize(bands);
}

Strips::Part Strips::partOf(int strip, int band) const {
  const int sweep = sweepOf(strip), place = strip % perSweep();
  const bool second_pass = isOfOtherSweep(sweep, band);
  // Once the sweeps have met neither has a first pass left, so the other one's buffers are free;
  // and as a rule the thread that has used them is here now.
  const int buffers = second_pass && threads_ <= 2 ? firstOf(1 - sweep) + place : strip;
  return {strip,
          buffers,
          sweep,
          band,
          edges_[sweep][place],
          edges_[sweep][place + 1],
          second_pass,
          {turnOf(sweep, band), turnOf(sweep, band - 1)}};
}

void Strips::takeTurn(int strip, int band, bool whole) {
  const int sweep = sweepOf(strip);
  if (strip != firstOf(sweep)) return;
  turns_[sweep][band] = turnOf(sweep, band - 1) + (whole ? 0 : 1);
}

bool Strips::claim(int strip, int band) {
  int holder = kNobody;
  const int sweep = sweepOf(strip);
  return claims_[claimPlace(sweep, band)].compare_exchange_strong(holder, sweep) || holder == sweep;
}

Strips::Need Strips::needOf(int strip) const {
  const int stage = strips_[strip].stage, band = stage / kStages, band_begin = band * kStages;
  const bool begins = stage == band_begin, ends = stage == band_begin + kStages - 1;
  const int sweep = sweepOf(strip), place = strip % perSweep();
  // The left neighbour must have finished this band, the right one must have begun the one above.
  if (begins && place > 0) return {strip - 1, band_begin + kStages};
  if (ends && place + 1 < perSweep()) return {strip + 1, band_begin - kStages + 1};
  // What the other sweep has begun with it must have finished, the last of its strips last.
  if (begins && band < bands_.count() && isOfOtherSweep(sweep, band)) {
    return {firstOf(2 - sweep) - 1, (bands_.opposite(band) + 1) * kStages};
  }
  return {strip, stage};
}

bool Strips::canGoOn(int strip) const { return !isFinished(strip) && isMet(needOf(strip)); }

bool Strips::meetsOtherSweep(int strip) const {
  const int stage = strips_[strip].stage;
  return stage % kStages == 0 && canGoOn(strip) && isOfOtherSweep(sweepOf(strip), stage / kStages);
}

bool Strips::tryToTake(int strip) {
  Strip& free = strips_[strip];
  for (;;) {
    if (!isFree(strip) || free.taken.exchange(true)) return false;
    if (canGoOn(strip)) break;
    // Another thread had it in between. Whoever has just found it taken counts on this one, so it
    // must look again.
    leave(strip);
  }
  free.wanted = false;
  return true;
}

bool Strips::tryToJoin(int strip, int stage) {
  if (perSweep() != 2 || strip % 2 != 0) return false;
  Strip& other = strips_[strip + 1];
  if (other.stage != stage || other.wanted || other.taken.exchange(true)) return false;
  if (other.stage != stage) {
    leave(strip + 1);  // another thread had it in between
    return false;
  }
  other.cpu = currentCpu();
  other.joined = true;
  return true;
}

void Strips::release(int strip, int stage) {
  strips_[strip].joined = false;
  reach(strip, stage);
  leave(strip);
}

int Strips::findJoined(int own) const {
  for (int i = 0; i < count(); ++i) {
    const int strip = (own + i) % count();
    if (strips_[strip].joined) return strip;
  }
  return -1;
}

void Strips::leave(int strip) {
  Strip& left = strips_[strip];
  left.cpu = kNoCpu;
  left.taken = false;
  if (left.sleepers == 0) return;
  { const std::lock_guard<std::mutex> lock(left.mutex); }
  left.changed.notify_all();
}

void Strips::reach(int strip, int stage) {
  Strip& reached = strips_[strip];
  reached.stage = stage;
  // Either this sees what is awaited, or who waits sees the stage before it falls asleep.
  if (reached.awaited > stage) return;
  {
    const std::lock_guard<std::mutex> lock(reached.mutex);
    reached.awaited = kNever;
  }
  reached.changed.notify_all();
}

bool Strips::waitInHand(int strip) {
  if (isFinished(strip)) return false;
  const Need need = needOf(strip);
  const auto changed = [&] { return hasChanged(need); };
  std::atomic<int>& spins = strips_[strip].spins;
  if (!changed() && sharesMyCpu(strips_[need.strip].cpu)) return false;
  if (spinUntil(changed, spins)) {
    spins = std::min(2 * spins, kMostSpins);
  } else {
    spins = std::max(spins / 2, kFewestSpins);
  }
  return isMet(need);
}

Strips::Need Strips::findHolder(int strip) const {
  Need need{strip, strips_[strip].stage + 1};
  while (!strips_[need.strip].taken) {
    const Need next = needOf(need.strip);
    if (isMet(next)) return {need.strip, 0};
    need = next;
  }
  return need;
}

int Strips::take(int* own) {
  for (;;) {
    for (int i = 0; i < count(); ++i) {
      const int strip = (*own + i) % count();
      if (tryToTake(strip)) return strip;
    }
    if (isFinished(*own) || strips_[*own].taken) {
      const int joined = findJoined(*own);
      // All others are in the hands of threads that will do the rest.
      if (joined < 0 && isFinished(*own)) return -1;
      if (joined >= 0) *own = joined;
    }
    const Need need = findHolder(*own);
    if (need.stage == 0) continue;
    // To take turns with a thread on the same core is slower than to leave it all to that one.
    if (sharesMyCpu(strips_[need.strip].cpu)) return -1;
    strips_[*own].wanted = true;
    if (!spinUntil([&] { return hasChanged(need); }, strips_[*own].spins)) sleepFor(need);
  }
}

void Strips::sleepFor(const Need& need) {
  Strip& other = strips_[need.strip];
  std::unique_lock<std::mutex> lock(other.mutex);
  ++other.sleepers;
  for (;;) {
    other.awaited = std::min<int>(other.awaited, need.stage);
    if (hasChanged(need)) break;
    other.changed.wait(lock);
  }
  --other.sleepers;
}

}  // namespace adaptive_grid_stereo
