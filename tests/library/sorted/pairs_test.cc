#include <gtest/gtest.h>
#include "halfspace/halfspace.h"
