#define HALFSPACE_BASELINE N_BASELINE_SSE4
#include "bench/baselines/baselines_vectorised-inl.h"
