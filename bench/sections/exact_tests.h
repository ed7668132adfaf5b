// What an exact test of a pair costs.
#ifndef HALFSPACE_BENCH_SECTIONS_EXACT_TESTS_H_
#define HALFSPACE_BENCH_SECTIONS_EXACT_TESTS_H_

#include <string>

#include "bench/measure/measure.h"

namespace halfspace::bench {

class Run;

struct ExactTest {
  std::string name;
  Ratio ns;  // of a pair
};

// Of two triangles around each other, one test at a time.
ExactTest MeasureExactTest(Run& run);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_SECTIONS_EXACT_TESTS_H_
