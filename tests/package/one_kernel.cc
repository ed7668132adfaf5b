// The least program with a kernel in it: one call of c/kernels.h.
#include <cstdint>

#include "halfspace/c/kernels.h"

int main() {
  const float zero[] = {0};
  const float one[] = {1};
  const float* planes[] = {zero, zero, zero, one, one, one};
  const float query[] = {1, 1, 1, 2, 2, 2};
  std::uint64_t mask = 0;
  hs_box3_mask(planes, 1, query, &mask);
  return mask == 1 ? 0 : 1;
}
