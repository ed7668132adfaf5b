#include "bench/baselines/baselines.h"

namespace halfspace::bench {

#define HALFSPACE_DECLARE_BASELINE(name)    \
  namespace name {                          \
  void CountWithOr(const SimplexJob& job);  \
  void CountWithAnd(const SimplexJob& job); \
  }

HALFSPACE_DECLARE_BASELINE(N_BASELINE_SSE4)
HALFSPACE_DECLARE_BASELINE(N_BASELINE_AVX2)
HALFSPACE_DECLARE_BASELINE(N_BASELINE_AVX512)
HALFSPACE_DECLARE_BASELINE(N_BASELINE_PLAIN)

VectorisedForms VectorisedFormsFor(std::string_view target) {
#ifdef HALFSPACE_BENCH_X86_BASELINES
  if (target.starts_with("AVX3")) {
    return {{{"or", &N_BASELINE_AVX512::CountWithOr},
             {"and", &N_BASELINE_AVX512::CountWithAnd}}};
  }
  if (target == "AVX2") {
    return {{{"or", &N_BASELINE_AVX2::CountWithOr},
             {"and", &N_BASELINE_AVX2::CountWithAnd}}};
  }
  if (target == "SSE4") {
    return {{{"or", &N_BASELINE_SSE4::CountWithOr},
             {"and", &N_BASELINE_SSE4::CountWithAnd}}};
  }
#else
  (void)target;
#endif
  return {{{"or", &N_BASELINE_PLAIN::CountWithOr},
           {"and", &N_BASELINE_PLAIN::CountWithAnd}}};
}

}  // namespace halfspace::bench
