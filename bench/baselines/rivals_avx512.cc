#define HALFSPACE_RIVAL N_RIVAL_AVX512
#include "bench/baselines/rivals_vectorised-inl.h"
