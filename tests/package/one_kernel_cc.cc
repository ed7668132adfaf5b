// one_kernel.c in C++.
#include <cstdint>

#include "halfspace/kernels.h"

int main() {
  const float zero[] = {0};
  const float one[] = {1};
  const float* planes[] = {zero, zero, zero, one, one, one};
  const float query[] = {1, 1, 1, 2, 2, 2};
  std::uint64_t mask = 0;
  halfspace::SurvivorsOfBoxes3(planes, 1, query, &mask);
  return mask == 1 ? 0 : 1;
}
