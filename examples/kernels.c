// Boxes in the arrays of a program in C, tested by an unchecked call.
#include <halfspace/c/kernels.h>
#include <stdio.h>

int main(void) {
  const float min_x[] = {0, 2, 4}, min_yz[] = {0, 0, 0};
  const float max_x[] = {1, 3, 5}, max_yz[] = {1, 1, 1};
  const float* planes[] = {min_x, min_yz, min_yz, max_x, max_yz, max_yz};
  const float query[] = {2.5f, 0, 0, 4, 1, 1};  // min x y z, max x y z
  uint64_t mask[1];
  hs_box3_mask(planes, 3, query, mask);
  for (int i = 0; i < 3; ++i) {
    if (mask[0] >> i & 1) printf("box %d could touch the query\n", i);
  }
}
