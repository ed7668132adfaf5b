#define HALFSPACE_RIVAL N_RIVAL_SSE4
#include "bench/baselines/rivals_vectorised-inl.h"
