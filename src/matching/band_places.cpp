#include "src/matching/band_places.h"

namespace adaptive_grid_stereo {
namespace {

// Enough for the sets of places that bands take in turn near borders between strips (BandTurns), up
// to eight threads' four strips in each of the three rows of cells: or else each band would make a
// table.
constexpr std::size_t kMostTables = 64;

// The first step that a table has: that of the first pixel of the row above the band.
constexpr int kFirstStep = -kBandLag;

std::vector<std::uint8_t*> makePlaces(const std::array<PathRow, kPlacesPerStep>& rows, int width) {
  const std::size_t steps = static_cast<std::size_t>(width) + kLargestLag - kFirstStep;
  std::vector<std::uint8_t*> places(kPlacesPerStep * steps, nullptr);
  for (int i = 0; i < kPlacesPerStep; ++i) {
    if (rows[i] == nullptr) continue;
    const int lag = kBandLag * (i - 1) - kFirstStep;
    // The pixel before the first one is read, too, of the band's rows.
    for (int u = i == 0 ? 0 : -1; u < width; ++u) {
      places[static_cast<std::size_t>(kPlacesPerStep) * (u + lag) + i] = rows[i][u];
    }
  }
  return places;
}

}  // namespace

StepPlaces BandPlaces::find(const SweepRow* rows, int row_count, int width) {
  std::array<PathRow, kPlacesPerStep> wanted{};
  wanted[0] = rows[0].above;
  for (int r = 0; r < row_count; ++r) wanted[r + 1] = rows[r].current;
  const auto stepZero = [](const Table& table) {
    return table.places.data() - kPlacesPerStep * kFirstStep;
  };
  for (const Table& table : tables_) {
    if (table.rows == wanted) return stepZero(table);
  }
  if (tables_.size() == kMostTables) forget();
  tables_.push_back({wanted, makePlaces(wanted, width)});
  return stepZero(tables_.back());
}

}  // namespace adaptive_grid_stereo
