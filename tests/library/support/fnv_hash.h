// One number that stands for many: FNV-1a, 64 bits, over bytes whose order is
// that of the values and not of the machine's memory.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_FNV_HASH_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_FNV_HASH_H_

#include <bit>
#include <cstdint>

namespace halfspace::testing {

class FnvHash {
 public:
  void Add(std::uint64_t value) {
    for (int byte = 0; byte < 8; ++byte) {
      hash_ ^= (value >> (8 * byte)) & 0xff;
      hash_ *= 0x100000001b3u;
    }
  }

  // Both zeros count as one: they compare alike, and which of them a sum or a
  // minimum gives is nobody's promise.
  void AddFloat(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    Add(bits == 0x80000000u ? 0 : bits);
  }

  template <typename Range>
  void AddAll(const Range& values) {
    for (const auto value : values) Add(value);
  }

  template <typename Range>
  void AddAllFloats(const Range& values) {
    for (const float value : values) AddFloat(value);
  }

  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325u;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_FNV_HASH_H_
