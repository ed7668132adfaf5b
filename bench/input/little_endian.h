// Numbers of binary files, which have their lowest byte first.
#ifndef HALFSPACE_BENCH_INPUT_LITTLE_ENDIAN_H_
#define HALFSPACE_BENCH_INPUT_LITTLE_ENDIAN_H_

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace halfspace::bench {

// Of at most 4 bytes.
inline std::uint32_t LittleEndian(std::string_view bytes) {
  std::uint32_t value = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) {
    value = value << 8 | static_cast<unsigned char>(bytes[i]);
  }
  return value;
}

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_INPUT_LITTLE_ENDIAN_H_
