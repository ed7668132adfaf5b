// Vectors that start on a cache line, so that no vector load of theirs touches
// two.
#ifndef HALFSPACE_BENCH_BASE_ALIGNED_VECTOR_H_
#define HALFSPACE_BENCH_BASE_ALIGNED_VECTOR_H_

#include <cstddef>
#include <new>
#include <vector>

namespace halfspace::bench {

template <typename T>
struct CacheLineAllocator {
  using value_type = T;

  static constexpr std::align_val_t kAlignment{64};

  CacheLineAllocator() = default;
  template <typename Other>
  // NOLINTNEXTLINE(google-explicit-constructor): allocators are converted.
  CacheLineAllocator(const CacheLineAllocator<Other>& /*other*/) {}

  T* allocate(std::size_t count) {
    return static_cast<T*>(::operator new(count * sizeof(T), kAlignment));
  }
  void deallocate(T* memory, std::size_t /*count*/) {
    ::operator delete(memory, kAlignment);
  }
  friend bool operator==(const CacheLineAllocator&,
                         const CacheLineAllocator&) = default;
};

template <typename T>
using AlignedVector = std::vector<T, CacheLineAllocator<T>>;

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_BASE_ALIGNED_VECTOR_H_
