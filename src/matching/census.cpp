#include "adaptive_grid_stereo/matching/census.h"

#include "src/matching/sweep.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/matching/census.cpp"
#include "src/matching/simd-inl.h"
//
#include "src/matching/hamming_distance-inl.h"

HWY_BEFORE_NAMESPACE();
namespace adaptive_grid_stereo {
namespace HWY_NAMESPACE {
namespace hn = AGS_SIMD;

// The bits so far, and one more: whether neighbour < centre.
template <class V>
HWY_INLINE V PushBit(V bits, V neighbour, V centre) {
  const hn::ScalableTag<std::uint8_t> d;
  const V moved = hn::Add(bits, bits), one = hn::Set(d, std::uint8_t{1});
#if HWY_TARGET == HWY_AVX3_DL
  const __mmask64 less = _mm512_cmplt_epu8_mask(neighbour.raw, centre.raw);
  return V{_mm512_mask_add_epi8(moved.raw, less, moved.raw, one.raw)};
#else
  // A saturated difference, of which only "not zero" counts.
  return hn::Or(moved, hn::Min(hn::SaturatedSub(centre, neighbour), one));
#endif
}

// kSign is -1 for mirrored images, whose left neighbours lie to the right.
template <int kHalfWidth, int kHalfHeight, int kSign>
HWY_ATTR void CensusOfWindow(const PaddedImage& image, int y, std::uint8_t* planes) {
  const hn::ScalableTag<std::uint8_t> d;
  constexpr int kBits = (2 * kHalfWidth + 1) * (2 * kHalfHeight + 1) - 1;
  const std::size_t stride = censusStride(image.width());
  for (int x = 0; x < image.width(); x += static_cast<int>(hn::Lanes(d))) {
    const auto centre = hn::LoadU(d, image.row(y) + x);
    auto byte = hn::Zero(d);
    int bit = 0;
    for (int j = -kHalfHeight; j <= kHalfHeight; ++j) {
      const std::uint8_t* row = image.row(y + j) + x;
      for (int i = -kHalfWidth; i <= kHalfWidth; ++i) {
        if (j == 0 && i == 0) continue;
        byte = PushBit(byte, hn::LoadU(d, row + kSign * i), centre);
        ++bit;
        if (bit % 8 == 0 || bit == kBits) {
          hn::StoreU(byte, d, planes + (bit - 1) / 8 * stride + kCensusMargin + x);
          byte = hn::Zero(d);
        }
      }
    }
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
  if (!kCensusByPixel) return CensusRow(image, mirrored, y, window, row);
  CensusRow(image, mirrored, y, window, planes);
  OrderByPixel(image.width(), window, planes, row);
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
