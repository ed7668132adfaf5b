// What no public header may do; the test of the headers must notice.
#include "hwy/base.h"
