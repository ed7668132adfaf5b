// The shape of what a per-target pass leaves behind: plain function pointers.
// No Highway here, so that everything above the kernels compiles without it.
#ifndef HALFSPACE_DISPATCH_KERNEL_TABLE_H_
#define HALFSPACE_DISPATCH_KERNEL_TABLE_H_

#include <array>
#include <cstddef>
#include <cstdint>

namespace halfspace::dispatch {

// Every kernel returns the Highway bit of the target it was compiled for, so
// that a result can say what really ran.
struct Counted {
  std::size_t count;
  std::int64_t target;
};

// The sinks of one shape and schedule. `planes` and `query` are those of
// detail::Scan, `size` the number of objects.
struct Kernels {
  std::int64_t (*mask)(const float* const* planes, const float* query,
                       std::size_t size, std::uint64_t* mask,
                       std::uint64_t flip);
  Counted (*indices)(const float* const* planes, const float* query,
                     std::size_t size, std::uint32_t* indices,
                     std::size_t capacity);
  Counted (*count)(const float* const* planes, const float* query,
                   std::size_t size);
  Counted (*any)(const float* const* planes, const float* query,
                 std::size_t size);
};

// Shape and schedule, as the kernels see them.
enum Variant : std::size_t {
  kSimplexFlat,
  kSimplexByAxis,
  kAabbFlat,
  kAabbByAxis,
  kAaboFlat,
  kAaboByAxis,
  kAaboBySimplex,
  kVariants
};

using KernelTable = std::array<Kernels, kVariants>;

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_KERNEL_TABLE_H_
