#ifndef ADAPTIVE_GRID_STEREO_TEST_FUZZ_FUZZ_INPUT_H
#define ADAPTIVE_GRID_STEREO_TEST_FUZZ_FUZZ_INPUT_H

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

namespace adaptive_grid_stereo {
namespace fuzz {

/// Ends the process with a sentence, as a sanitizer would.
inline void require(bool holds, const char* sentence) {
  if (holds) return;
  std::fprintf(stderr, "fuzzing found: %s\n", sentence);
  std::abort();
}

/// Takes values from the bytes of the fuzzer, front to back; zeros when they are used up.
class FuzzInput {
 public:
  FuzzInput(const std::uint8_t* data, std::size_t size) : at_(data), left_(size) {}

  std::size_t left() const { return left_; }

  template <typename Value>
  Value bits() {
    Value value{};
    const std::size_t taken = std::min(sizeof(Value), left_);
    if (taken > 0) std::memcpy(&value, at_, taken);
    at_ += taken;
    left_ -= taken;
    return value;
  }
  bool flag() { return bits<std::uint8_t>() % 2 == 1; }
  /// Both ends included.
  int between(int low, int high) {
    return low + static_cast<int>(bits<std::uint16_t>() % static_cast<unsigned>(high - low + 1));
  }
  std::string text(std::size_t longest) {
    const std::size_t taken =
        std::min({static_cast<std::size_t>(bits<std::uint8_t>()), longest, left_});
    const std::string result(reinterpret_cast<const char*>(at_), taken);
    at_ += taken;
    left_ -= taken;
    return result;
  }
  /// A length as honest messages have it, or one with which sums and products overflow.
  std::uint32_t length() {
    constexpr std::uint32_t kHostile[] = {0,     1,          15,          16384,
                                          16385, 0x7fffffff, 0x80000000U, 0xffffffffU};
    const int kind = between(0, 11);
    return kind < 8    ? kHostile[kind]
           : kind == 8 ? bits<std::uint32_t>()
                       : static_cast<std::uint32_t>(between(0, 64));
  }
  /// A number near 1, one of the odd ones, or any pattern of bits.
  double number() {
    constexpr double kOdd[] = {0.0,
                               -0.0,
                               -1.0,
                               1e-310,
                               1e308,
                               -1e308,
                               std::numeric_limits<double>::infinity(),
                               -std::numeric_limits<double>::infinity(),
                               std::numeric_limits<double>::quiet_NaN()};
    const int kind = between(0, 19);
    if (kind < 9) return kOdd[kind];
    return kind == 9 ? bits<double>() : bits<std::int16_t>() / 256.0;
  }
  /// As number(), but mostly `usual`.
  double near(double usual) { return between(0, 15) == 0 ? number() : usual; }

 private:
  const std::uint8_t* at_;
  std::size_t left_;
};

}  // namespace fuzz
}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_TEST_FUZZ_FUZZ_INPUT_H
