#define HALFSPACE_RIVAL baseline
#include "bench/rivals_vectorised-inl.h"
