#define HALFSPACE_BASELINE N_BASELINE_AVX2
#include "bench/baselines/baselines_vectorised-inl.h"
