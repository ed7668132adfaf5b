#define HALFSPACE_RIVAL N_RIVAL_BASELINE
#include "bench/rivals_vectorised-inl.h"
