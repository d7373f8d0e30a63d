#ifndef ADAPTIVE_GRID_STEREO_SRC_MATCHING_BAND_RUNS_H
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_BAND_RUNS_H

#include <array>
#include <cstdint>
#include <vector>

#include "src/matching/sweep.h"

namespace adaptive_grid_stereo {

/// The runs of a band's steps: each as long as one kernel can do it.
class BandRuns {
 public:
  /// Those of steps [first, last) of a band. Remembers a few answers, since most bands are alike.
  /// The result is valid until the next call.
  const std::vector<StepRun>& find(const SweepFrame& frame, const SweepRow* rows, int row_count,
                                   int first, int last);

  /// Forgets all answers. Must be called where tables of kinds have changed.
  void forget() { answers_.clear(); }

 private:
  // What an answer depends on, beside what is in the tables of kinds.
  struct Question {
    std::array<const std::uint8_t*, kBandRows> kinds{};
    std::array<int, 6> numbers{};
    bool operator==(const Question& other) const {
      return kinds == other.kinds && numbers == other.numbers;
    }
  };
  struct Answer {
    Question question;
    std::vector<StepRun> runs;
  };

  std::vector<Answer> answers_;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_BAND_RUNS_H
