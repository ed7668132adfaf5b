#define HALFSPACE_BASELINE N_BASELINE_AVX512
#include "bench/baselines/baselines_vectorised-inl.h"
