#include "src/matching/band_runs.h"

#include <algorithm>

namespace adaptive_grid_stereo {
namespace {

// Enough for each of a band's three stages, or the whole, in any of the three rows of cells of
// either sweep, or between two of these.
constexpr std::size_t kMostAnswers = 48;

// Columns whose disparities all stay inside the right image; none if no kernel makes use of that.
struct InnerColumns {
  int begin, end;
  bool holds(int u) const { return u >= begin && u < end; }
};

InnerColumns findInnerColumns(const SweepFrame& frame) {
  if (frame.long_range) return {0, 0};
  const int begin = std::max(0, frame.min_disparity + frame.layout.range - 1);
  const int end = std::min(frame.width, frame.width + frame.min_disparity);
  if (frame.course.flip == 0) return {begin, end};
  return {frame.width - end, frame.width - begin};
}

// The steps from `step` on in which neither the rows nor the kinds of their pixels change.
StepRun findSteps(const SweepFrame& frame, const SweepRow* rows, int row_count, int step,
                  const InnerColumns& inner) {
  const ActiveRows active = findActiveRows(frame.width, row_count, step);
  if (active.count() <= 0) return {step, step + 1, active, false, false, kOutside};
  const int first = step - kBandLag * active.first, last = step - kBandLag * (active.last - 1);
  const int kind = rows[active.first].kinds[first];
  bool uniform = true;
  int steps = active.last < row_count ? kBandLag * active.last - step : frame.width;
  for (int r = active.first; r < active.last; ++r) {
    const int u = step - kBandLag * r;
    uniform = uniform && rows[r].kinds[u] == kind;
    steps = std::min(steps, rows[r].kind_ends[u] - u);
  }
  for (const int edge : {inner.begin, inner.end}) {
    for (const int u : {first, last}) {
      if (edge > u) steps = std::min(steps, edge - u);
    }
  }
  const bool all_inner = inner.holds(first) && inner.holds(last);
  return {step, step + steps, active, uniform, all_inner, kind};
}

// The longest run from `step` on that one kernel can do.
StepRun findRun(const SweepFrame& frame, const SweepRow* rows, int row_count, int step,
                int last_step, const InnerColumns& inner) {
  StepRun run = findSteps(frame, rows, row_count, step, inner);
  while (!run.uniform && run.end < last_step) {
    const StepRun next = findSteps(frame, rows, row_count, run.end, inner);
    if (next.uniform || next.inner != run.inner) break;
    run.end = next.end;
  }
  run.end = std::min(run.end, last_step);
  return run;
}

}  // namespace

const std::vector<StepRun>& BandRuns::find(const SweepFrame& frame, const SweepRow* rows,
                                           int row_count, int first, int last) {
  const InnerColumns inner = findInnerColumns(frame);
  Question question;
  for (int r = 0; r < row_count; ++r) question.kinds[r] = rows[r].kinds;
  question.numbers = {frame.width, inner.begin, inner.end, row_count, first, last};
  for (const Answer& answer : answers_) {
    if (answer.question == question) return answer.runs;
  }
  if (answers_.size() == kMostAnswers) forget();
  answers_.push_back({question, {}});
  std::vector<StepRun>& runs = answers_.back().runs;
  for (int step = first; step < last; step = runs.back().end) {
    runs.push_back(findRun(frame, rows, row_count, step, last, inner));
  }
  return runs;
}

}  // namespace adaptive_grid_stereo
