#include "src/matching/band_places.h"

#include <algorithm>
#include <utility>

namespace adaptive_grid_stereo {
namespace {

// Enough for the sets of places that bands take in turn near borders between strips (BandTurns), up
// to eight threads' four strips in each of the three rows of cells: or else each band would make
// tables.
constexpr std::size_t kMostAnswers = 64;

// Steps of a band and the rows that they go through.
struct BandSteps {
  const BandPathRows& rows;
  int begin, end, width;

  // Calls f(index, first, last) for each row from an index on and its pixels [first, last) at steps
  // [from, end) that are no farther than `margin` outside of the image.
  template <class F>
  void forRows(int first_index, int from, int margin, const F& f) const {
    for (int i = first_index; i < kPlacesPerStep; ++i) {
      if (rows.places[i] == nullptr) continue;
      const int lag = kBandLag * (i - kRowsAbove);
      const int first = std::max(-margin, from - lag), last = std::min(width + margin, end - lag);
      if (first < last) f(i, first, last);
    }
  }

  // Whether pixels of the band have paths of a kind, and some that these may come from have not.
  bool isMixed(PixelKind kind) const {
    std::uint8_t most = kOutside, least = kEight;
    forRows(kRowsAbove, begin, 0, [&](int i, int first, int last) {
      for (int u = first; u < last; ++u) most = std::max(most, rows.kinds[i][u]);
    });
    forRows(0, begin - kStepsBack, 0, [&](int i, int first, int last) {
      if (rows.kinds[i] == nullptr) return;
      for (int u = first; u < last; ++u) least = std::min(least, rows.kinds[i][u]);
    });
    return most >= kind && least < kind;
  }

  std::vector<std::uint8_t*> placesFor(PixelKind kind, std::uint8_t* zero) const {
    const int from = begin - kStepsBack;
    std::vector<std::uint8_t*> table(static_cast<std::size_t>(kPlacesPerStep) * (end - from), zero);
    forRows(0, from, kPathMargin, [&](int i, int first, int last) {
      const int lag = kBandLag * (i - kRowsAbove);
      const std::uint8_t* kinds = rows.kinds[i];
      std::uint8_t** to = table.data() + kPlacesPerStep * (lag - from) + i;
      for (int u = first; u < last; ++u) {
        if (kinds != nullptr && kinds[u] < kind) continue;
        to[kPlacesPerStep * u] = rows.places[i][u];
      }
    });
    return table;
  }
};

}  // namespace

void BandPlaces::forget() {
  answers_.clear();
  tables_.clear();
}

StepPlaces BandPlaces::findTable(const Table& wanted, int width, std::uint8_t* zero) {
  auto table = std::find_if(tables_.begin(), tables_.end(), [&](const Table& known) {
    return known.kind == wanted.kind && known.begin == wanted.begin && known.end == wanted.end &&
           known.rows == wanted.rows;
  });
  if (table == tables_.end()) {
    Table made = wanted;
    const BandSteps steps{wanted.rows, wanted.begin, wanted.end, width};
    made.places = steps.placesFor(wanted.kind, zero);
    table = tables_.insert(table, std::move(made));
  }
  // Of step 0, in the first row of the band.
  return table->places.data() + kPlacesPerStep * (kStepsBack - table->begin) + kRowsAbove;
}

PathPlaces BandPlaces::find(const BandPathRows& rows, int begin, int end, int width,
                            std::uint8_t* zero) {
  const auto answers = [&](const Answer& answer) {
    return answer.begin == begin && answer.end == end && answer.rows == rows;
  };
  if (last_ < answers_.size() && answers(answers_[last_])) return answers_[last_].places;
  const auto known = std::find_if(answers_.begin(), answers_.end(), answers);
  if (known != answers_.end()) {
    last_ = known - answers_.begin();
    return known->places;
  }
  if (answers_.size() == kMostAnswers) forget();
  const StepPlaces all = findTable({{rows.places, {}}, begin, end, kOutside, {}}, width, zero);
  const auto seenBy = [&](PixelKind kind) {
    if (!BandSteps{rows, begin, end, width}.isMixed(kind)) return all;
    return findTable({rows, begin, end, kind, {}}, width, zero);
  };
  last_ = answers_.size();
  answers_.push_back({rows, begin, end, {all, seenBy(kFour), seenBy(kEight)}});
  return answers_.back().places;
}

}  // namespace adaptive_grid_stereo
