#define HALFSPACE_BASELINE N_BASELINE_PLAIN
#include "bench/baselines/baselines_vectorised-inl.h"
