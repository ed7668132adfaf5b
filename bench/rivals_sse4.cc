#define HALFSPACE_RIVAL N_RIVAL_SSE4
#include "bench/rivals_vectorised-inl.h"
