#include "bench/rivals.h"

namespace halfspace::bench {

#define HALFSPACE_DECLARE_RIVAL(name)       \
  namespace name {                          \
  void CountWithOr(const SimplexJob& job);  \
  void CountWithAnd(const SimplexJob& job); \
  }

HALFSPACE_DECLARE_RIVAL(sse4)
HALFSPACE_DECLARE_RIVAL(avx2)
HALFSPACE_DECLARE_RIVAL(avx512)
HALFSPACE_DECLARE_RIVAL(baseline)

VectorisedForms VectorisedFormsFor(std::string_view target) {
#ifdef HALFSPACE_BENCH_X86_RIVALS
  if (target.starts_with("AVX3")) {
    return {{{"or", &avx512::CountWithOr}, {"and", &avx512::CountWithAnd}}};
  }
  if (target == "AVX2") {
    return {{{"or", &avx2::CountWithOr}, {"and", &avx2::CountWithAnd}}};
  }
  if (target == "SSE4") {
    return {{{"or", &sse4::CountWithOr}, {"and", &sse4::CountWithAnd}}};
  }
#else
  (void)target;
#endif
  return {{{"or", &baseline::CountWithOr}, {"and", &baseline::CountWithAnd}}};
}

}  // namespace halfspace::bench
