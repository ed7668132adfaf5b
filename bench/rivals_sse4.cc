#define HALFSPACE_RIVAL sse4
#include "bench/rivals_vectorised-inl.h"
