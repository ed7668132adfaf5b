#define HALFSPACE_RIVAL avx2
#include "bench/rivals_vectorised-inl.h"
