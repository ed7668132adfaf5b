// Memory between two pages that fault, so that one element too far is a crash.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_GUARDED_MEMORY_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_GUARDED_MEMORY_H_

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <span>
#include <system_error>

namespace halfspace::testing {

// Where in the memory a span touches a guard page.
enum class GuardedSide { kBefore, kAfter };

class GuardedMemory {
 public:
  explicit GuardedMemory(std::size_t bytes) {
    const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    // A page at least: not every system protects nothing.
    size_ = std::max(page, (bytes + page - 1) / page * page);
    mapping_size_ = size_ + 2 * page;
    void* mapping = mmap(nullptr, mapping_size_, PROT_NONE,
                         MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    Check(mapping != MAP_FAILED, "mmap");
    mapping_ = static_cast<std::byte*>(mapping);
    begin_ = mapping_ + page;
    Check(mprotect(begin_, size_, PROT_READ | PROT_WRITE) == 0, "mprotect");
  }
  GuardedMemory(const GuardedMemory&) = delete;
  GuardedMemory& operator=(const GuardedMemory&) = delete;
  ~GuardedMemory() { munmap(mapping_, mapping_size_); }

  // `count` elements right after the first guard or right before the last.
  template <typename T>
  std::span<T> Get(std::size_t count, GuardedSide side) const {
    std::byte* from = side == GuardedSide::kBefore
                          ? begin_
                          : begin_ + size_ - count * sizeof(T);
    return {reinterpret_cast<T*>(from), count};
  }

 private:
  static void Check(bool done, const char* call) {
    if (!done) throw std::system_error(errno, std::generic_category(), call);
  }

  std::byte* mapping_ = nullptr;
  std::byte* begin_ = nullptr;
  std::size_t size_ = 0;
  std::size_t mapping_size_ = 0;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_GUARDED_MEMORY_H_
