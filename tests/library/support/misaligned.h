// Pointers that no call may take.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_MISALIGNED_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_MISALIGNED_H_

#include <cstdint>

namespace halfspace::testing {

// `pointer`, one byte further.
template <typename T>
T* Misaligned(T* pointer) {
  return reinterpret_cast<T*>(reinterpret_cast<std::uintptr_t>(pointer) + 1);
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_MISALIGNED_H_
