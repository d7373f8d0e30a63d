#ifndef ADAPTIVE_GRID_STEREO_SRC_MATCHING_PORTABLE_SIMD_H
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_PORTABLE_SIMD_H

// The part of Google Highway's interface that the kernels use, on arrays of 16 bytes, in plain C++.
// It serves where Highway is missing, and CPUs without any of its targets. The meaning of each
// function is Highway's.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <type_traits>

#if defined(AGS_PORTABLE_SIMD)
#define HWY_TARGET 1
#define HWY_SCALAR 1
#define HWY_AVX2 2
#define HWY_AVX3 3
#define HWY_AVX3_DL 4
#define HWY_NEON 5
#define HWY_MAX_BYTES 16
#define HWY_NAMESPACE N_PORTABLE
#define HWY_BEFORE_NAMESPACE() static_assert(true, "")
#define HWY_AFTER_NAMESPACE() static_assert(true, "")
#define HWY_ONCE 1
#define HWY_ATTR
#define HWY_INLINE inline
#define HWY_NOINLINE
#define HWY_EXPORT(function) static_assert(true, "")
#define HWY_DYNAMIC_DISPATCH(function) N_PORTABLE::function
namespace hwy {
inline void FlushStream() {}
}  // namespace hwy
#endif

namespace adaptive_grid_stereo {
namespace portable_simd {

template <typename T, std::size_t N>
struct Tag {};
template <typename T>
using ScalableTag = Tag<T, 16 / sizeof(T)>;
template <typename T>
using Full128 = Tag<T, 16 / sizeof(T)>;

template <typename T, std::size_t N>
struct Vector {
  T lane[N];
};
template <std::size_t N>
struct MaskOf {
  bool lane[N];
};

template <class D>
struct TagTraits;
template <typename T, std::size_t N>
struct TagTraits<Tag<T, N>> {
  using Lane = T;
  static constexpr std::size_t kBytes = N * sizeof(T);
  using HalfTag = Tag<T, N / 2>;
};
template <typename T, class D>
using Repartition = Tag<T, TagTraits<std::remove_const_t<D>>::kBytes / sizeof(T)>;
template <class D>
using Half = typename TagTraits<std::remove_const_t<D>>::HalfTag;
template <class D>
struct VecOf;
template <typename T, std::size_t N>
struct VecOf<Tag<T, N>> {
  using Type = Vector<T, N>;
};
template <class D>
using Vec = typename VecOf<std::remove_const_t<D>>::Type;

template <typename T, std::size_t N>
constexpr std::size_t Lanes(Tag<T, N>) {
  return N;
}

template <typename T, std::size_t N>
Vector<T, N> LoadU(Tag<T, N>, const T* from) {
  Vector<T, N> v;
  std::memcpy(v.lane, from, sizeof(v.lane));
  return v;
}
template <typename T, std::size_t N>
Vector<T, N> Load(Tag<T, N> d, const T* from) {
  return LoadU(d, from);
}
template <typename T, std::size_t N>
Vector<T, N> LoadDup128(Tag<T, N> d, const T* from) {
  return LoadU(d, from);
}
template <typename T, std::size_t N>
void StoreU(Vector<T, N> v, Tag<T, N>, T* to) {
  std::memcpy(to, v.lane, sizeof(v.lane));
}
template <typename T, std::size_t N>
void Store(Vector<T, N> v, Tag<T, N> d, T* to) {
  StoreU(v, d, to);
}
template <typename T, std::size_t N>
void Stream(Vector<T, N> v, Tag<T, N> d, T* to) {
  StoreU(v, d, to);
}
template <typename T, std::size_t N, typename U>
Vector<T, N> Set(Tag<T, N>, U value) {
  Vector<T, N> v;
  std::fill(v.lane, v.lane + N, static_cast<T>(value));
  return v;
}
template <typename T, std::size_t N, typename U>
Vector<T, N> Iota(Tag<T, N>, U first) {
  Vector<T, N> v;
  std::iota(v.lane, v.lane + N, static_cast<T>(first));
  return v;
}
template <typename T, std::size_t N>
Vector<T, N> Zero(Tag<T, N> d) {
  return Set(d, T{0});
}
template <typename T, std::size_t N>
T GetLane(Vector<T, N> v) {
  return v.lane[0];
}

#define AGS_LANEWISE(Name, expression)                       \
  template <typename T, std::size_t N>                       \
  Vector<T, N> Name(Vector<T, N> v, const Vector<T, N>& w) { \
    for (std::size_t i = 0; i < N; ++i) {                    \
      const T a = v.lane[i], b = w.lane[i];                  \
      v.lane[i] = static_cast<T>(expression);                \
    }                                                        \
    return v;                                                \
  }
AGS_LANEWISE(Min, a < b ? a : b)
AGS_LANEWISE(Max, a > b ? a : b)
AGS_LANEWISE(Add, a + b)
AGS_LANEWISE(Sub, a - b)
AGS_LANEWISE(And, a& b)
AGS_LANEWISE(Or, a | b)
AGS_LANEWISE(Xor, a ^ b)
AGS_LANEWISE(SaturatedSub, a > b ? a - b : 0)
AGS_LANEWISE(SaturatedAdd, static_cast<T>(a + b) < a ? static_cast<T>(-1) : a + b)
#undef AGS_LANEWISE

template <int kBits, typename T, std::size_t N>
Vector<T, N> ShiftLeft(Vector<T, N> v) {
  // Negative numbers must not be shifted left.
  for (T& lane : v.lane) lane = static_cast<T>(static_cast<std::make_unsigned_t<T>>(lane) << kBits);
  return v;
}
template <int kBits, typename T, std::size_t N>
Vector<T, N> ShiftRight(Vector<T, N> v) {
  for (T& lane : v.lane) lane = static_cast<T>(lane >> kBits);
  return v;
}
template <typename T, std::size_t N>
Vector<T, N> PopulationCount(Vector<T, N> v) {
  for (T& lane : v.lane) {
    unsigned x = lane;
    x -= (x >> 1) & 0x55u;
    x = (x & 0x33u) + ((x >> 2) & 0x33u);
    lane = static_cast<T>((x + (x >> 4)) & 0x0Fu);
  }
  return v;
}

template <typename T, std::size_t N, typename U, std::size_t M>
Vector<T, N> BitCast(Tag<T, N>, const Vector<U, M>& v) {
  static_assert(sizeof(T) * N == sizeof(U) * M, "a cast keeps the size");
  Vector<T, N> result;
  std::memcpy(result.lane, v.lane, sizeof(result.lane));
  return result;
}

template <typename T, std::size_t N>
Vector<T, N> InterleaveLower(Tag<T, N>, const Vector<T, N>& a, const Vector<T, N>& b) {
  Vector<T, N> v;
  for (std::size_t i = 0; i < N; ++i) v.lane[i] = i % 2 ? b.lane[i / 2] : a.lane[i / 2];
  return v;
}
template <typename T, std::size_t N>
Vector<T, N> InterleaveUpper(Tag<T, N>, const Vector<T, N>& a, const Vector<T, N>& b) {
  Vector<T, N> v;
  for (std::size_t i = 0; i < N; ++i) {
    v.lane[i] = i % 2 ? b.lane[N / 2 + i / 2] : a.lane[N / 2 + i / 2];
  }
  return v;
}
template <int kBytes, typename T, std::size_t N>
Vector<T, N> ShiftRightBytes(Tag<T, N>, const Vector<T, N>& v) {
  Vector<T, N> result = {};
  std::memcpy(result.lane, reinterpret_cast<const char*>(v.lane) + kBytes, sizeof(v.lane) - kBytes);
  return result;
}
template <typename T, std::size_t N>
Vector<T, N / 2> LowerHalf(const Vector<T, N>& v) {
  Vector<T, N / 2> half;
  std::memcpy(half.lane, v.lane, sizeof(half.lane));
  return half;
}
template <std::size_t N>
Vector<std::uint8_t, N> TableLookupBytes(const Vector<std::uint8_t, N>& table,
                                         Vector<std::uint8_t, N> index) {
  for (std::uint8_t& lane : index.lane) lane = table.lane[lane % N];
  return index;
}

template <typename T, std::size_t N>
MaskOf<N> Eq(const Vector<T, N>& a, const Vector<T, N>& b) {
  MaskOf<N> mask;
  for (std::size_t i = 0; i < N; ++i) mask.lane[i] = a.lane[i] == b.lane[i];
  return mask;
}
template <typename T, std::size_t N>
MaskOf<N> FirstN(Tag<T, N>, std::size_t count) {
  MaskOf<N> mask;
  for (std::size_t i = 0; i < N; ++i) mask.lane[i] = i < count;
  return mask;
}
template <typename T, std::size_t N>
Vector<T, N> IfThenElse(const MaskOf<N>& mask, Vector<T, N> yes, const Vector<T, N>& no) {
  for (std::size_t i = 0; i < N; ++i) {
    if (!mask.lane[i]) yes.lane[i] = no.lane[i];
  }
  return yes;
}
template <typename T, std::size_t N>
bool AllTrue(Tag<T, N>, const MaskOf<N>& mask) {
  return std::all_of(mask.lane, mask.lane + N, [](bool b) { return b; });
}
// One lane at least must be true.
template <typename T, std::size_t N>
std::size_t FindKnownFirstTrue(Tag<T, N>, const MaskOf<N>& mask) {
  return static_cast<std::size_t>(std::find(mask.lane, mask.lane + N, true) - mask.lane);
}

}  // namespace portable_simd
}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_PORTABLE_SIMD_H
