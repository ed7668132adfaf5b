// The least program with a kernel in it, in C. one_kernel_inline.cc is the same
// program by the other way to the kernel.
#include <halfspace/c/kernels.h>
#include <stdint.h>

int main(void) {
  const float zero[] = {0};
  const float one[] = {1};
  const float* planes[] = {zero, zero, zero, one, one, one};
  const float query[] = {1, 1, 1, 2, 2, 2};
  uint64_t mask = 0;
  hs_box3_mask(planes, 1, query, &mask);
  return mask == 1 ? 0 : 1;
}
