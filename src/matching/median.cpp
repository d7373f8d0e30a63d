#include <algorithm>
#include <array>
#include <vector>

#include "adaptive_grid_stereo/matching/refinement.h"
#include "adaptive_grid_stereo/matching/stereo_matcher.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/matching/median.cpp"
#include "src/matching/simd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace adaptive_grid_stereo {
namespace HWY_NAMESPACE {
namespace hn = AGS_SIMD;

template <class V>
HWY_INLINE void Sort(V* a, V* b) {
  const V smaller = hn::Min(*a, *b);
  *b = hn::Max(*a, *b);
  *a = smaller;
}

// Sorts each column of three, then the median is that of the largest low, the median middle and the
// smallest high.
template <class V>
HWY_INLINE V MedianOfNine(V* p) {
  for (int i = 0; i < 9; i += 3) {
    Sort(&p[i], &p[i + 1]);
    Sort(&p[i + 1], &p[i + 2]);
    Sort(&p[i], &p[i + 1]);
  }
  V low = hn::Max(hn::Max(p[0], p[3]), p[6]);
  V high = hn::Min(hn::Min(p[2], p[5]), p[8]);
  Sort(&p[1], &p[4]);
  V middle = hn::Max(p[1], hn::Min(p[4], p[7]));
  Sort(&low, &high);
  return hn::Max(low, hn::Min(high, middle));
}

// rows: three rows of which pixels -1 .. width may be read (and vectors' worth beyond).
HWY_ATTR void MedianRow(const std::int16_t* const* rows, int width, std::int16_t* target) {
  const hn::ScalableTag<std::int16_t> d;
  const auto invalid = hn::Set(d, kInvalidDisparity);
  for (int x = 0; x < width; x += static_cast<int>(hn::Lanes(d))) {
    const auto centre = hn::LoadU(d, rows[1] + x);
    hn::Vec<decltype(d)> values[9];
    for (int i = 0; i < 9; ++i) {
      const auto value = hn::LoadU(d, rows[i / 3] + x + i % 3 - 1);
      values[i] = hn::IfThenElse(hn::Eq(value, invalid), centre, value);
    }
    hn::StoreU(hn::IfThenElse(hn::Eq(centre, invalid), centre, MedianOfNine(values)), d,
               target + x);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace adaptive_grid_stereo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace adaptive_grid_stereo {
HWY_EXPORT(MedianRow);

void medianOfValid(const cv::Mat& source, int first_row, int last_row, cv::Mat* target) {
  constexpr int kPad = 64;
  const int width = source.cols;
  const std::size_t stride = static_cast<std::size_t>(width) + 2 * kPad;
  // Three rows with invalid pixels around them, and a fourth that takes what whole vectors write.
  std::vector<std::int16_t> padded(4 * stride, kInvalidDisparity);
  const auto slot = [&](int y) {
    return padded.data() + static_cast<std::size_t>((y + 3) % 3) * stride + kPad;
  };
  const auto loadRow = [&](int y) {
    if (y < 0 || y >= source.rows) {
      std::fill(slot(y), slot(y) + width, kInvalidDisparity);
    } else {
      const std::int16_t* row = source.ptr<std::int16_t>(y);
      std::copy(row, row + width, slot(y));
    }
  };
  std::int16_t* result = padded.data() + 3 * stride + kPad;
  loadRow(first_row - 1);
  loadRow(first_row);
  for (int y = first_row; y < last_row; ++y) {
    loadRow(y + 1);
    const std::int16_t* rows[3] = {slot(y - 1), slot(y), slot(y + 1)};
    HWY_DYNAMIC_DISPATCH(MedianRow)(rows, width, result);
    std::copy(result, result + width, target->ptr<std::int16_t>(y));
  }
}

}  // namespace adaptive_grid_stereo
#endif  // HWY_ONCE
