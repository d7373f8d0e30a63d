#ifndef ADAPTIVE_GRID_STEREO_SRC_MATCHING_ALIGNED_BUFFER_H
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_ALIGNED_BUFFER_H

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace adaptive_grid_stereo {

/// Uninitialised memory on a cache line (large buffers: huge pages where the kernel gives them),
/// which only ever grows.
template <typename T>
class AlignedBuffer {
 public:
  /// At least `count` elements; old contents are lost if the buffer has to grow. Throws
  /// std::bad_alloc. Returns whether it grew.
  bool reserve(std::size_t count) {
    if (count <= capacity_) return false;
    constexpr std::size_t kHugePage = std::size_t{2} << 20;
    const std::size_t alignment = count * sizeof(T) >= kHugePage ? kHugePage : 64;
    const std::size_t bytes = (count * sizeof(T) + alignment - 1) / alignment * alignment;
    data_.reset();
    capacity_ = 0;
    data_.reset(static_cast<T*>(std::aligned_alloc(alignment, bytes)));
    if (!data_) throw std::bad_alloc();
#if defined(__linux__) && defined(MADV_HUGEPAGE)
    if (alignment == kHugePage) madvise(data_.get(), bytes, MADV_HUGEPAGE);
#endif
    capacity_ = count;
    return true;
  }

  T* data() { return data_.get(); }
  const T* data() const { return data_.get(); }

 private:
  struct Free {
    void operator()(T* pointer) const { std::free(pointer); }
  };
  std::unique_ptr<T, Free> data_;
  std::size_t capacity_ = 0;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_ALIGNED_BUFFER_H
