#define HALFSPACE_RIVAL avx512
#include "bench/rivals_vectorised-inl.h"
