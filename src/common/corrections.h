#ifndef ADAPTIVE_GRID_STEREO_SRC_COMMON_CORRECTIONS_H
#define ADAPTIVE_GRID_STEREO_SRC_COMMON_CORRECTIONS_H

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace adaptive_grid_stereo {

/// Brings parameters into their ranges and keeps one sentence per value that had to change.
class Corrections {
 public:
  /// Limits a value to [low, high].
  void limit(const char* name, int low, int high, int* value) {
    set(name, std::clamp(*value, low, high), rangeOf(low, high), value);
  }
  /// The same; NaN becomes `fallback`.
  void limit(const char* name, double low, double high, double fallback, double* value) {
    const double wanted = std::isnan(*value) ? fallback : std::clamp(*value, low, high);
    set(name, wanted, rangeOf(low, high), value);
  }

  template <typename T>
  void set(const char* name, const T& wanted, const std::string& reason, T* value) {
    if (*value == wanted) return;
    sentences_.push_back(std::string(name) + ": " + text(*value) + " -> " + text(wanted) + " (" +
                         reason + ")");
    *value = wanted;
  }

  std::vector<std::string> take() { return std::move(sentences_); }

 private:
  template <typename T>
  static std::string rangeOf(T low, T high) {
    return "legal range " + text(low) + ".." + text(high);
  }

  template <typename T>
  static std::string text(const T& value) {
    std::ostringstream stream;
    stream << value;
    return stream.str();
  }

  std::vector<std::string> sentences_;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SRC_COMMON_CORRECTIONS_H
