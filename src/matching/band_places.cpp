#include "src/matching/band_places.h"

#include <algorithm>

namespace adaptive_grid_stereo {
namespace {

// How many steps before its own a pixel's paths come from: from the second row above, one pixel
// before.
constexpr int kStepsBack = kRowsAbove * kBandLag + 1;

// Steps of a band and the rows that they go through.
struct BandSteps {
  const BandPathRows& rows;
  int begin, end, width;

  // Calls f(index, first, last) for each row of the table and its pixels [first, last) at steps
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

  // Whether pixels of the band have paths of a kind, and whether some that these come from do not.
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

  std::size_t tableSize() const {
    return static_cast<std::size_t>(kPlacesPerStep) * (end - begin + kStepsBack);
  }
  // Of step 0, in the first row of the band.
  StepPlaces origin(const std::vector<std::uint8_t*>& table) const {
    return table.data() + kPlacesPerStep * (kStepsBack - begin) + kRowsAbove;
  }

  // The places as paths of a kind see them.
  std::vector<std::uint8_t*> places(PixelKind kind, std::uint8_t* zero) const {
    std::vector<std::uint8_t*> table(tableSize(), zero);
    const int from = begin - kStepsBack;
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

PathPlaces BandPlaces::find(const BandPathRows& rows, int begin, int end, int width,
                            std::uint8_t* zero) {
  for (const Answer& answer : answers_) {
    if (answer.begin == begin && answer.end == end && answer.rows == rows) return answer.places;
  }
  if (answers_.size() == kMostAnswers) forget();
  Answer answer{rows, begin, end, {}, {}, {}, {}};
  const BandSteps steps{rows, begin, end, width};
  answer.all = steps.places(kOutside, zero);
  if (steps.isMixed(kFour)) answer.four = steps.places(kFour, zero);
  if (steps.isMixed(kEight)) answer.eight = steps.places(kEight, zero);
  const auto originOf = [&](const std::vector<std::uint8_t*>& table) {
    return steps.origin(table.empty() ? answer.all : table);
  };
  answer.places = {originOf(answer.all), originOf(answer.four), originOf(answer.eight)};
  answers_.push_back(std::move(answer));
  return answers_.back().places;
}

}  // namespace adaptive_grid_stereo
