#define HALFSPACE_RIVAL N_RIVAL_BASELINE
#include "bench/baselines/rivals_vectorised-inl.h"
