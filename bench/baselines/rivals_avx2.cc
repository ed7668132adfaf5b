#define HALFSPACE_RIVAL N_RIVAL_AVX2
#include "bench/baselines/rivals_vectorised-inl.h"
