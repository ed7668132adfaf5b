#include "halfspace/detail/block_memory.h"

#include <new>

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

}  // namespace

void* AllocateBlock(std::size_t bytes) {
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

void FreeBlock(void* block, std::size_t bytes) {
  ::operator delete(block, AlignmentOf(bytes));
}

}  // namespace halfspace::detail
