#include "adaptive_grid_stereo/matching/census.h"

#include <algorithm>

#include "src/matching/sweep.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/matching/census.cpp"
#include "src/matching/simd-inl.h"
//
#include "src/matching/hamming_distance-inl.h"
#include "src/matching/repeat-inl.h"

HWY_BEFORE_NAMESPACE();
namespace adaptive_grid_stereo {
namespace HWY_NAMESPACE {
namespace hn = AGS_SIMD;

// Adds a bit to those of a byte so far: whether neighbour < centre. They come one after the other,
// down to kPlace 0.
template <int kPlace, class V>
HWY_INLINE V PushBit(V bits, V neighbour, V centre) {
  const hn::ScalableTag<std::uint8_t> d;
#if HWY_TARGET == HWY_AVX3_DL
  const V bit = hn::Set(d, static_cast<std::uint8_t>(1 << kPlace));
  const __mmask64 less = _mm512_cmplt_epu8_mask(neighbour.raw, centre.raw);
  return V{_mm512_mask_add_epi8(bits.raw, less, bits.raw, bit.raw)};
#else
  // A saturated difference, of which only "not zero" counts.
  const V one = hn::Set(d, std::uint8_t{1});
  return hn::Or(hn::Add(bits, bits), hn::Min(hn::SaturatedSub(centre, neighbour), one));
#endif
}

// kSign is -1 for mirrored images, whose left neighbours lie to the right.
template <int kHalfWidth, int kHalfHeight, int kSign>
HWY_ATTR void CensusOfWindow(const PaddedImage& image, int y, std::uint8_t* planes) {
  const hn::ScalableTag<std::uint8_t> d;
  constexpr int kColumns = 2 * kHalfWidth + 1, kRows = 2 * kHalfHeight + 1;
  constexpr int kBits = kColumns * kRows - 1;
  const std::size_t stride = censusStride(image.width());
  const std::uint8_t* rows[kRows];
  for (int j = 0; j < kRows; ++j) rows[j] = image.row(y + j - kHalfHeight);
  for (int x = 0; x < image.width(); x += static_cast<int>(hn::Lanes(d))) {
    const auto centre = hn::LoadU(d, rows[kHalfHeight] + x);
    Repeat<(kBits + 7) / 8>([&](auto plane) AGS_LAMBDA {
      constexpr int kFirst = 8 * decltype(plane)::value, kCount = std::min(8, kBits - kFirst);
      auto byte = hn::Zero(d);
      Repeat<kCount>([&](auto i) AGS_LAMBDA {
        constexpr int kBit = kFirst + decltype(i)::value;
        // The centre is none of the bits.
        constexpr int kPixel = kBit < kBits / 2 ? kBit : kBit + 1;
        constexpr int kRow = kPixel / kColumns, kColumn = kPixel % kColumns - kHalfWidth;
        const auto neighbour = hn::LoadU(d, rows[kRow] + x + kSign * kColumn);
        byte = PushBit<kCount - 1 - decltype(i)::value>(byte, neighbour, centre);
      });
      hn::StoreU(byte, d, planes + plane * stride + kCensusMargin + x);
    });
  }
}

template <int kSign>
HWY_ATTR void CensusOfRow(const PaddedImage& image, int y, CensusWindow window,
                          std::uint8_t* planes) {
  switch (window) {
    case CensusWindow::k5x5:
      return CensusOfWindow<2, 2, kSign>(image, y, planes);
    case CensusWindow::k7x7:
      return CensusOfWindow<3, 3, kSign>(image, y, planes);
    case CensusWindow::k9x7:
      return CensusOfWindow<4, 3, kSign>(image, y, planes);
  }
}

HWY_ATTR void CensusRow(const PaddedImage& image, bool mirrored, int y, CensusWindow window,
                        std::uint8_t* planes) {
  if (mirrored) {
    CensusOfRow<-1>(image, y, window, planes);
  } else {
    CensusOfRow<1>(image, y, window, planes);
  }
}

HWY_ATTR void OrderedCensusRow(const PaddedImage& image, bool mirrored, int y, CensusWindow window,
                               std::uint8_t* planes, std::uint8_t* row) {
  if (kCensusInOrder) return CensusRow(image, mirrored, y, window, row);
  CensusRow(image, mirrored, y, window, planes);
  OrderCensus(image.width(), window, planes, row);
}

}  // namespace HWY_NAMESPACE
}  // namespace adaptive_grid_stereo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace adaptive_grid_stereo {
HWY_EXPORT(CensusRow);
HWY_EXPORT(OrderedCensusRow);

void censusRow(const PaddedImage& image, bool mirrored, int y, CensusWindow window,
               std::uint8_t* planes) {
  HWY_DYNAMIC_DISPATCH(CensusRow)(image, mirrored, y, window, planes);
}

void orderedCensusRow(const PaddedImage& image, bool mirrored, int y, CensusWindow window,
                      std::uint8_t* planes, std::uint8_t* row) {
  HWY_DYNAMIC_DISPATCH(OrderedCensusRow)(image, mirrored, y, window, planes, row);
}

}  // namespace adaptive_grid_stereo
#endif  // HWY_ONCE
