// Hamming distances of census strings for a vector of disparities, and the order of the census
// bytes that they are made from. Included once per SIMD target.
#if defined(ADAPTIVE_GRID_STEREO_SRC_MATCHING_HAMMING_DISTANCE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef ADAPTIVE_GRID_STEREO_SRC_MATCHING_HAMMING_DISTANCE_INL_H
#undef ADAPTIVE_GRID_STEREO_SRC_MATCHING_HAMMING_DISTANCE_INL_H
#else
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_HAMMING_DISTANCE_INL_H
#endif

#include <cstring>

#include "adaptive_grid_stereo/matching/census.h"
#include "src/matching/sweep.h"

HWY_BEFORE_NAMESPACE();
namespace adaptive_grid_stereo {
namespace HWY_NAMESPACE {
namespace hn = AGS_SIMD;

#if HWY_TARGET == HWY_AVX3_DL

// Pixel by pixel, the eight bytes of a string side by side: they are compared and counted as one
// number, and all loads are aligned. (Plane by plane, 64 disparities would take eight loads that
// each touch two cache lines.)
constexpr bool kCensusInOrder = false;

// Where the interleaving below takes its pixels from, so that they come out in order: each of its
// steps stays within blocks of 16 bytes, and leaves two pixels to a block.
struct PixelOrder {
  alignas(64) std::uint8_t from[64];
};
constexpr PixelOrder makePixelOrder() {
  PixelOrder order{};
  for (int i = 0; i < 64; ++i) {
    const int block = i / 16, pair = i % 16 / 2;
    order.from[i] = static_cast<std::uint8_t>(8 * pair + 2 * block + i % 2);
  }
  return order;
}
static constexpr PixelOrder kPixelOrder = makePixelOrder();

// 64 pixels at a time; planes that the window does not fill are zero. Strings of the margins are
// left as they are.
HWY_INLINE void OrderCensus(int width, CensusWindow window, const std::uint8_t* planes,
                            std::uint8_t* row) {
  const hn::ScalableTag<std::uint8_t> d8;
  const hn::Repartition<std::uint16_t, decltype(d8)> d16;
  const hn::Repartition<std::uint32_t, decltype(d8)> d32;
  using V = hn::Vec<decltype(d8)>;
  const __m512i order = _mm512_load_si512(kPixelOrder.from);
  const std::size_t stride = censusStride(width);
  const int filled = censusPlanes(window);
  static_assert(kCensusMargin % 64 == 0, "pixel 0 must begin a vector");
  row += kCensusBytes * kCensusMargin;
  for (int x = kCensusMargin; x < kCensusMargin + width; x += 64, row += 64 * kCensusBytes) {
    V plane[kCensusBytes], twos[kCensusBytes], fours[kCensusBytes];
    for (int p = 0; p < kCensusBytes; ++p) {
      plane[p] = hn::Zero(d8);
      if (p < filled) {
        const V in_a_row = hn::LoadU(d8, planes + p * stride + x);
        plane[p] = V{_mm512_permutexvar_epi8(order, in_a_row.raw)};
      }
    }
    for (int p = 0; p < 4; ++p) {
      twos[p] = hn::InterleaveLower(d8, plane[2 * p], plane[2 * p + 1]);
      twos[p + 4] = hn::InterleaveUpper(d8, plane[2 * p], plane[2 * p + 1]);
    }
    for (int i = 0; i < 4; ++i) {
      const auto a = hn::BitCast(d16, twos[2 * i]), b = hn::BitCast(d16, twos[2 * i + 1]);
      fours[i / 2 * 4 + i % 2] = hn::BitCast(d8, hn::InterleaveLower(d16, a, b));
      fours[i / 2 * 4 + i % 2 + 2] = hn::BitCast(d8, hn::InterleaveUpper(d16, a, b));
    }
    for (int i = 0; i < 4; ++i) {
      const auto a = hn::BitCast(d32, fours[2 * i]), b = hn::BitCast(d32, fours[2 * i + 1]);
      hn::Store(hn::BitCast(d8, hn::InterleaveLower(d32, a, b)), d8, row + 128 * i);
      hn::Store(hn::BitCast(d8, hn::InterleaveUpper(d32, a, b)), d8, row + 128 * i + 64);
    }
  }
}

// Where the census strings of a pixel and of its first disparity stand. In the mirrored row,
// disparity index k is k strings further.
struct CensusPlaces {
  const std::uint8_t* left;
  const std::uint8_t* right;
  std::ptrdiff_t column;  // of the first disparity in the mirrored row
};

// Bytes from a pixel's string to the next one's.
constexpr int kCensusStep = kCensusBytes;

// How far ahead a pixel's strings are fetched [bytes].
constexpr int kCensusAhead = 24 * kCensusStep;

HWY_INLINE CensusPlaces FindCensus(const SweepFrame&, const BandRow& row, std::ptrdiff_t x,
                                   std::ptrdiff_t ahead) {
  const std::uint8_t* left = row.left + kCensusStep * x;
  const std::uint8_t* right = row.right - kCensusStep * x;
  // Among the many streams of path costs, hardware does not see that these two go on.
  __builtin_prefetch(left + ahead);
  __builtin_prefetch(right - ahead);
  return {left, right, row.first_column - x};
}

// Of nine vectors of strings, from a cache line's begin on, those wanted are strings t .. t + 63:
// all but the first t of the first vector, and the first t of the ninth, which fill its place.
struct StringPlaces {
  alignas(64) std::uint64_t of_ninth[8];  // all bits set where the ninth vector's strings belong
  // Where their counts are, in order, after eight vectors of eight counts each have been laid into
  // each other.
  alignas(64) std::uint8_t counts[64];
};
struct StringPlacesByBegin {
  StringPlaces from[8];
};
constexpr StringPlacesByBegin makeStringPlaces() {
  StringPlacesByBegin places{};
  for (int t = 0; t < 8; ++t) {
    for (int i = 0; i < t; ++i) places.from[t].of_ninth[i] = ~std::uint64_t{0};
    for (int i = 0; i < 64; ++i) {
      const int vector = (t + i) / 8 % 8, count = (t + i) % 8;
      // Packing leaves two counts of either vector of a pair in each block of 16 bytes; two pairs
      // are laid into each other byte by byte, and two of these packed again.
      const int pair = vector / 2, in_pair = 2 * (vector % 2) + count % 2;
      const int laid = 16 * (count / 2) + 8 * (pair / 2) + 2 * in_pair + pair % 2;
      places.from[t].counts[i] = static_cast<std::uint8_t>(laid);
    }
  }
  return places;
}
static constexpr StringPlacesByBegin kStringPlaces = makeStringPlaces();

// sums + a * b, of 16 bits that lie side by side, in 32 bits. (Highway makes sure that the CPU has
// this instruction, but up to 1.0.3 does not tell compilers, so there is no intrinsic for it.)
HWY_INLINE __m512i AddProducts(__m512i sums, __m512i a, __m512i b) {
  asm("vpdpwssd %2, %1, %0" : "+v"(sums) : "v"(a), "v"(b));
  return sums;
}

// Costs of a vector of disparities from index k on.
HWY_INLINE hn::Vec<hn::ScalableTag<std::uint8_t>> HammingDistances(const CensusPlaces& at, int k) {
  const hn::ScalableTag<std::uint64_t> d;
  const std::uintptr_t right = reinterpret_cast<std::uintptr_t>(at.right + kCensusBytes * k);
  const std::uint64_t* from = reinterpret_cast<const std::uint64_t*>(right & ~std::uintptr_t{63});
  const StringPlaces& places = kStringPlaces.from[right / kCensusBytes % 8];
  std::uint64_t string;
  std::memcpy(&string, at.left, sizeof(string));
  const auto left = hn::Set(d, string);
  const auto count = [&](int i) AGS_LAMBDA {
    auto strings = hn::Load(d, from + 8 * i);
    if (i == 0) {
      strings = hn::IfVecThenElse(hn::Load(d, places.of_ninth), hn::Load(d, from + 64), strings);
    }
    return hn::PopulationCount(hn::Xor(left, strings));
  };
  // Packing takes another of the CPU's ports than multiplying, which shifts and adds at once.
  const auto pair = [&](int i)
                        AGS_LAMBDA { return _mm512_packus_epi32(count(i).raw, count(i + 1).raw); };
  const __m512i second_byte = _mm512_set1_epi32(1 << 8);
  const auto twoPairs = [&](int i)
                            AGS_LAMBDA { return AddProducts(pair(i), pair(i + 2), second_byte); };
  const __m512i counts = _mm512_packus_epi32(twoPairs(0), twoPairs(4));
  return {_mm512_permutexvar_epi8(_mm512_load_si512(places.counts), counts)};
}

// Costs of kVectors vectors of disparities from index k on.
template <int kVectors, class V>
HWY_INLINE void HammingDistances(CensusWindow, const CensusPlaces& at, int k, V* costs) {
  for (int i = 0; i < kVectors; ++i) costs[i] = HammingDistances(at, k + 64 * i);
}

#else

// Plane by plane: byte p of all pixels' strings side by side.

#undef AGS_FAST_POPCOUNT
// Whether the target counts the bits of a byte in one instruction.
#if HWY_TARGET == HWY_NEON
#define AGS_FAST_POPCOUNT 1
#else
#define AGS_FAST_POPCOUNT 0
#endif

#if AGS_FAST_POPCOUNT

constexpr bool kCensusInOrder = true;

HWY_INLINE void OrderCensus(int, CensusWindow, const std::uint8_t*, std::uint8_t*) {}

#else

// Where counting takes a look-up per half a byte, the bits of three planes a, b, c are added up by
// full adders first. Strings are only compared by exclusive or, so these planes may hold a ^ b ^ c,
// a ^ b and a ^ c instead: of what they differ in, the adder's sum is the first one, and its carry
// takes but two instructions.
constexpr bool kCensusInOrder = false;

// Plane 7 stays, and plane 6 becomes the exclusive or of the first seven.
HWY_INLINE void OrderCensus(int width, CensusWindow window, const std::uint8_t* planes,
                            std::uint8_t* row) {
  const hn::ScalableTag<std::uint8_t> d;
  const std::size_t stride = censusStride(width);
  const int filled = censusPlanes(window);
  for (int x = kCensusMargin; x < kCensusMargin + width; x += static_cast<int>(hn::Lanes(d))) {
    auto sum = hn::Zero(d);
    for (int p = 0; p + 3 <= filled; p += 3) {
      const auto at = [&](int i) AGS_LAMBDA { return hn::LoadU(d, planes + (p + i) * stride + x); };
      const auto put = [&](int i, auto v)
                           AGS_LAMBDA { hn::StoreU(v, d, row + (p + i) * stride + x); };
      const auto a = at(0), ab = hn::Xor(a, at(1)), of_three = hn::Xor(ab, at(2));
      put(0, of_three);
      put(1, ab);
      put(2, hn::Xor(a, at(2)));
      sum = hn::Xor(sum, of_three);
    }
    if (filled < 8) continue;
    const auto at = [&](int p) AGS_LAMBDA { return hn::LoadU(d, planes + p * stride + x); };
    hn::StoreU(hn::Xor(sum, at(6)), d, row + 6 * stride + x);
    hn::StoreU(at(7), d, row + 7 * stride + x);
  }
}

#endif

// Bytes from a pixel's string to the next one's, in each plane.
constexpr int kCensusStep = 1;

// How far ahead a pixel's bytes are fetched.
constexpr int kCensusAhead = 72;

// Where the census bytes of a pixel and of its first disparity stand. In the mirrored row,
// disparity index k is k bytes further.
struct CensusPlaces {
  const std::uint8_t* left;
  const std::uint8_t* right;
  std::size_t stride;
  std::ptrdiff_t column;  // of the first disparity in the mirrored row
};

HWY_INLINE CensusPlaces FindCensus(const SweepFrame& frame, const BandRow& row, std::ptrdiff_t x,
                                   std::ptrdiff_t ahead) {
  const std::size_t stride = censusStride(frame.width);
  const std::uint8_t* left = row.left + x;
  const std::uint8_t* right = row.right - x;
  // Among the many streams of path costs, hardware does not see that these go on. One plane per
  // pixel in turn.
  const std::size_t plane = (x & (kCensusBytes - 1)) * stride;
  __builtin_prefetch(left + plane + ahead);
  __builtin_prefetch(right + plane - ahead);
  return {left, right, stride, row.first_column - x};
}

// What the strings of a pixel and of a few vectors of disparities differ in, plane by plane.
template <int kVectors>
struct Difference {
  using D = hn::ScalableTag<std::uint8_t>;
  using V = hn::Vec<D>;
  HWY_ATTR Difference(const CensusPlaces& at, int k) : at_(at), k_(k) {}

  HWY_INLINE void Plane(int p, V* x) const {
    const D d;
    const V left = hn::Set(d, at_.left[p * at_.stride]);
    const std::uint8_t* right = at_.right + p * at_.stride + k_;
    for (int i = 0; i < kVectors; ++i) x[i] = hn::Xor(left, hn::LoadU(d, right + i * hn::Lanes(d)));
  }

 private:
  const CensusPlaces& at_;
  int k_;
};

#if AGS_FAST_POPCOUNT

template <int kPlanes, int kVectors, class V>
HWY_INLINE void CountDifferences(const Difference<kVectors>& difference, V* counts) {
  difference.Plane(0, counts);
  for (int i = 0; i < kVectors; ++i) counts[i] = hn::PopulationCount(counts[i]);
  for (int p = 1; p < kPlanes; ++p) {
    V x[kVectors];
    difference.Plane(p, x);
    for (int i = 0; i < kVectors; ++i) counts[i] = hn::Add(counts[i], hn::PopulationCount(x[i]));
  }
}

#else

// kWeight times the number of bits set in each byte.
template <int kWeight, class V>
HWY_INLINE V CountBits(V bits) {
  const hn::ScalableTag<std::uint8_t> d;
  constexpr std::uint8_t k1 = kWeight, k2 = 2 * kWeight, k3 = 3 * kWeight, k4 = 4 * kWeight;
  alignas(16) static constexpr std::uint8_t kCounts[16] = {0,  k1, k1, k2, k1, k2, k2, k3,
                                                           k1, k2, k2, k3, k2, k3, k3, k4};
  const V table = hn::LoadDup128(d, kCounts);
  const V low = hn::And(bits, hn::Set(d, std::uint8_t{15})), high = hn::ShiftRight<4>(bits);
  return hn::Add(hn::TableLookupBytes(table, low), hn::TableLookupBytes(table, high));
}

// Adds up, bit by bit, the differences of three planes from p on, as OrderCensus() leaves them.
template <int kVectors, class V>
HWY_INLINE void AddPlanes(const Difference<kVectors>& difference, int p, V* sum, V* carry) {
  V ab[kVectors], ac[kVectors];
  difference.Plane(p, sum);
  difference.Plane(p + 1, ab);
  difference.Plane(p + 2, ac);
  for (int i = 0; i < kVectors; ++i) carry[i] = hn::Xor(sum[i], hn::Or(ab[i], ac[i]));
}

template <int kPlanes, int kVectors, class V>
HWY_INLINE void CountDifferences(const Difference<kVectors>& difference, V* counts) {
  V sum_a[kVectors], carry_a[kVectors];
  AddPlanes<kVectors>(difference, 0, sum_a, carry_a);
  if constexpr (kPlanes == 3) {
    for (int i = 0; i < kVectors; ++i) {
      counts[i] = hn::Add(CountBits<1>(sum_a[i]), CountBits<2>(carry_a[i]));
    }
    return;
  }
  V sum_b[kVectors], carry_b[kVectors], of_seven[kVectors];
  AddPlanes<kVectors>(difference, 3, sum_b, carry_b);
  if constexpr (kPlanes == 8) difference.Plane(6, of_seven);
  for (int i = 0; i < kVectors; ++i) {
    // Of all planes but the last of eight: what counts one, then what counts two and four.
    V ones = hn::Xor(sum_a[i], sum_b[i]), carry_c;
    if constexpr (kPlanes == 8) {
      carry_c = hn::Xor(of_seven[i], hn::Or(ones, hn::Xor(sum_b[i], of_seven[i])));
      ones = of_seven[i];
    } else {
      carry_c = hn::And(sum_a[i], sum_b[i]);
    }
    const V ab = hn::Xor(carry_a[i], carry_b[i]), ac = hn::Xor(carry_a[i], carry_c);
    const V twos = hn::Xor(ab, carry_c), fours = hn::Xor(twos, hn::Or(ab, ac));
    counts[i] = hn::Add(hn::Add(CountBits<1>(ones), CountBits<2>(twos)), CountBits<4>(fours));
  }
  if constexpr (kPlanes == 8) {
    V last[kVectors];
    difference.Plane(7, last);
    for (int i = 0; i < kVectors; ++i) counts[i] = hn::Add(counts[i], CountBits<1>(last[i]));
  }
}

#endif

// Costs of kVectors vectors of disparities from index k on.
template <int kVectors, class V>
HWY_INLINE void HammingDistances(CensusWindow window, const CensusPlaces& at, int k, V* costs) {
  const Difference<kVectors> difference(at, k);
  switch (window) {
    case CensusWindow::k5x5:
      return CountDifferences<censusPlanes(CensusWindow::k5x5)>(difference, costs);
    case CensusWindow::k7x7:
      return CountDifferences<censusPlanes(CensusWindow::k7x7)>(difference, costs);
    case CensusWindow::k9x7:
      break;
  }
  CountDifferences<censusPlanes(CensusWindow::k9x7)>(difference, costs);
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace adaptive_grid_stereo
HWY_AFTER_NAMESPACE();

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_HAMMING_DISTANCE_INL_H
