#include <cstdint>
#include <cstdlib>
#include <limits>
#include <new>

#include "dispatch/errors/error.h"
#include "halfspace/detail/plane_arrays.h"

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace halfspace::detail {
namespace {

constexpr std::size_t kLine = 64;
constexpr std::size_t kHugePage = std::size_t{2} << 20;

std::align_val_t AlignmentOf(std::size_t bytes) {
  return std::align_val_t{bytes < 2 * kHugePage ? kLine : kHugePage};
}

[[noreturn]] void ThrowBadAlloc() {
#if defined(__cpp_exceptions)
  throw std::bad_alloc();
#else
  std::abort();
#endif
}

void* AllocateFrom(const MemoryResource& memory, std::size_t bytes) {
  void* block = memory.allocate(memory.context, bytes, kLine);
  if (block == nullptr) ThrowBadAlloc();
  if (reinterpret_cast<std::uintptr_t>(block) % kLine != 0) {
    FreeBlock(memory, block, bytes);
    dispatch::ThrowInvalid("MemoryResource::allocate", "the result",
                           "memory aligned to 64 bytes", "a misaligned block");
  }
  return block;
}

}  // namespace

void* AllocateBlock(const MemoryResource& memory, std::size_t bytes) {
  // Operator new may round up to the alignment, which would be 0.
  if (bytes > std::numeric_limits<std::size_t>::max() - kHugePage) {
    ThrowBadAlloc();
  }
  if (memory.allocate != nullptr) return AllocateFrom(memory, bytes);
  void* block = ::operator new(bytes, AlignmentOf(bytes));
#if defined(__linux__) && defined(MADV_HUGEPAGE)
  // Huge pages, because reading a survivor's record in a large world would
  // otherwise cost a walk through page tables besides the cache miss. This is
  // only advice, so the result is ignored.
  if (bytes >= 2 * kHugePage) {
    (void)::madvise(block, bytes / kHugePage * kHugePage, MADV_HUGEPAGE);
  }
#endif
  return block;
}

void FreeBlock(const MemoryResource& memory, void* block, std::size_t bytes) {
  if (memory.deallocate != nullptr) {
    memory.deallocate(memory.context, block, bytes, kLine);
  } else {
    ::operator delete(block, AlignmentOf(bytes));
  }
}

}  // namespace halfspace::detail
