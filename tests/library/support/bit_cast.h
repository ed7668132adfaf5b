// std::bit_cast for libc++ 13, which Emscripten 3.1.6 has. Included before each
// test there.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_BIT_CAST_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_BIT_CAST_H_

#include <version>

#if !defined(__cpp_lib_bit_cast)
namespace std {

template <typename To, typename From>
constexpr To bit_cast(const From& from) {
  return __builtin_bit_cast(To, from);
}

}  // namespace std
#endif

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_BIT_CAST_H_
