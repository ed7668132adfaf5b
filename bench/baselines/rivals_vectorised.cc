#include "bench/baselines/rivals.h"

namespace halfspace::bench {

#define HALFSPACE_DECLARE_RIVAL(name)       \
  namespace name {                          \
  void CountWithOr(const SimplexJob& job);  \
  void CountWithAnd(const SimplexJob& job); \
  }

HALFSPACE_DECLARE_RIVAL(N_RIVAL_SSE4)
HALFSPACE_DECLARE_RIVAL(N_RIVAL_AVX2)
HALFSPACE_DECLARE_RIVAL(N_RIVAL_AVX512)
HALFSPACE_DECLARE_RIVAL(N_RIVAL_BASELINE)

VectorisedForms VectorisedFormsFor(std::string_view target) {
#ifdef HALFSPACE_BENCH_X86_RIVALS
  if (target.starts_with("AVX3")) {
    return {{{"or", &N_RIVAL_AVX512::CountWithOr},
             {"and", &N_RIVAL_AVX512::CountWithAnd}}};
  }
  if (target == "AVX2") {
    return {{{"or", &N_RIVAL_AVX2::CountWithOr},
             {"and", &N_RIVAL_AVX2::CountWithAnd}}};
  }
  if (target == "SSE4") {
    return {{{"or", &N_RIVAL_SSE4::CountWithOr},
             {"and", &N_RIVAL_SSE4::CountWithAnd}}};
  }
#else
  (void)target;
#endif
  return {{{"or", &N_RIVAL_BASELINE::CountWithOr},
           {"and", &N_RIVAL_BASELINE::CountWithAnd}}};
}

}  // namespace halfspace::bench
