// Internal. What a SortedWorld owns, and the calls of sorted.h after the types
// are gone. Not part of the interface.
#ifndef HALFSPACE_DETAIL_SORTED_H_
#define HALFSPACE_DETAIL_SORTED_H_

#include <array>
#include <cstddef>
#include <cstdint>

#include "halfspace/detail/plane_arrays.h"
#include "halfspace/export.h"
#include "halfspace/memory.h"
#include "halfspace/span.h"
#include "halfspace/targets.h"

namespace halfspace {

enum class Order : std::uint8_t;

namespace detail {

struct SortedKernels;

// The kernels of sorted worlds with kAxes axes, of each compiled target, best
// first: an object file of the library for each, as KernelsOf of scan.h.
template <std::size_t kAxes>
struct HALFSPACE_API SortedKernelsOf {
  static const SortedKernels* const kTargets;
};
extern template struct SortedKernelsOf<2>;
extern template struct SortedKernelsOf<3>;
extern template struct SortedKernelsOf<4>;

// 64 to the power of this is more than 2^32 objects.
inline constexpr std::size_t kMostLevels = 6;

// Level 0 are the objects. Node i of another level encloses block i of the
// level below it: 64 objects or nodes that follow each other.
struct SortedLevel {
  std::size_t size = 0;
  std::byte* blocks = nullptr;     // kernels/sorted/block.h
  std::array<float*, 8> planes{};  // all minima, then all maxima
  // Of nodes, a bit each: all objects in it have a minimum and a maximum on
  // each axis, in this order. So those of a node inside a query survive.
  std::uint64_t* regular = nullptr;
  bool is_prefetched = false;  // as its blocks are more than a cache holds
};

struct SortedLevels {
  std::size_t count = 0;
  std::array<SortedLevel, kMostLevels> level{};
  std::uint32_t* ids = nullptr;  // of objects, by position
};

struct SortedShape {
  const SortedKernels* kernels;  // of each target
  std::uint8_t axes;
  bool has_max;
};

// One block of memory, that of `memory`, and where its parts begin.
class HALFSPACE_API SortedTree {
 public:
  SortedTree(const SortedShape& shape, const MemoryResource& memory);
  SortedTree(const SortedTree& other, const MemoryResource& memory);
  SortedTree(const SortedTree& other) : SortedTree(other, MemoryResource()) {}
  SortedTree(SortedTree&& other) noexcept;
  SortedTree& operator=(const SortedTree& other);
  SortedTree& operator=(SortedTree&& other);
  ~SortedTree();
  friend void swap(SortedTree& a, SortedTree& b) noexcept { a.Swap(b); }

  // Replaces the content. The planes may not be its own.
  void Build(const FloatColumns& objects, Order order, Target target);

  const MemoryResource& memory() const { return memory_; }
  const SortedShape& shape() const { return shape_; }
  const SortedLevels& levels() const { return levels_; }
  std::size_t size() const { return levels_.level[0].size; }
  std::size_t bytes() const { return bytes_; }

 private:
  void Allocate(std::size_t objects);
  void Free();
  void Swap(SortedTree& other) noexcept;

  SortedShape shape_;
  MemoryResource memory_;
  std::byte* block_ = nullptr;
  std::size_t bytes_ = 0;
  SortedLevels levels_;
};

// Returns whether to go on.
using IdsFunction = bool (*)(void* context, Span<const std::uint32_t> ids);

// One query: all its minima, then all its maxima; of simplices only maxima.
HALFSPACE_API std::size_t SortedSurvivors(const SortedTree& tree,
                                          const float* query,
                                          Span<std::uint32_t> ids,
                                          Target target);
HALFSPACE_API std::size_t SortedCount(const SortedTree& tree,
                                      const float* query, Target target);
// Returns whether there is one, and its id.
HALFSPACE_API bool SortedAny(const SortedTree& tree, const float* query,
                             std::uint32_t& id, Target target);
HALFSPACE_API void SortedForEach(const SortedTree& tree, const float* query,
                                 IdsFunction function, void* context,
                                 Target target);

// Several, one after another.
HALFSPACE_API std::size_t SortedSurvivorsOfMany(
    const SortedTree& tree, const float* queries, std::size_t query_count,
    Span<std::uint32_t> ids, Span<std::size_t> offsets, Target target);

}  // namespace detail
}  // namespace halfspace

#endif  // HALFSPACE_DETAIL_SORTED_H_
