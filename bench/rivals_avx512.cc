#define HALFSPACE_RIVAL N_RIVAL_AVX512
#include "bench/rivals_vectorised-inl.h"
