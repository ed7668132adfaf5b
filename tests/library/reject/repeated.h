// Arrays of more bytes than there is memory, backed again and again by the
// same.
#ifndef HALFSPACE_TESTS_LIBRARY_REJECT_REPEATED_H_
#define HALFSPACE_TESTS_LIBRARY_REJECT_REPEATED_H_

#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <vector>

namespace halfspace::testing {

// Room for `count` elements, at first all `value`: mappings of one chunk, in a
// row. What is written to one of them is in all of them; but what is written to
// the last one stays there, and keeps that page apart from then on.
template <typename T>
class Repeated {
 public:
  Repeated(T value, std::size_t count) {
    const std::size_t chunks = (count + kChunk - 1) / kChunk;
    size_ = chunks * kBytes;
    const int file = memfd_create("halfspace-huge-world", 0);
    const std::vector<T> chunk(kChunk, value);
    ok_ = file >= 0 &&
          write(file, chunk.data(), kBytes) == static_cast<ssize_t>(kBytes);
    void* all = mmap(nullptr, size_, PROT_NONE,
                     MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    ok_ = ok_ && all != MAP_FAILED;
    begin_ = static_cast<std::byte*>(all);
    for (std::size_t c = 0; ok_ && c < chunks; ++c) {
      const int kind = c + 1 == chunks ? MAP_PRIVATE : MAP_SHARED;
      ok_ = mmap(begin_ + c * kBytes, kBytes, PROT_READ | PROT_WRITE,
                 kind | MAP_FIXED, file, 0) != MAP_FAILED;
    }
    if (file >= 0) close(file);
  }
  Repeated(const Repeated&) = delete;
  Repeated& operator=(const Repeated&) = delete;
  ~Repeated() {
    if (begin_ != nullptr && begin_ != MAP_FAILED) munmap(begin_, size_);
  }

  bool ok() const { return ok_; }
  T* data() const { return reinterpret_cast<T*>(begin_); }

 private:
  static constexpr std::size_t kBytes = std::size_t{1} << 22;
  static constexpr std::size_t kChunk = kBytes / sizeof(T);

  std::size_t size_;
  std::byte* begin_ = nullptr;
  bool ok_ = false;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_REJECT_REPEATED_H_
