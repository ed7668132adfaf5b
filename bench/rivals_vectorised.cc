#include "bench/rivals.h"

namespace halfspace::bench {

#define HALFSPACE_DECLARE_RIVAL(name)          \
  namespace name {                             \
  void CountWithOr(const SimplexJob& job);     \
  void CountWithChoice(const SimplexJob& job); \
  }

HALFSPACE_DECLARE_RIVAL(sse4)
HALFSPACE_DECLARE_RIVAL(avx2)
HALFSPACE_DECLARE_RIVAL(avx512)
HALFSPACE_DECLARE_RIVAL(baseline)

VectorisedForms VectorisedFormsFor(std::string_view target) {
#ifdef HALFSPACE_BENCH_X86_RIVALS
  if (target.starts_with("AVX3")) {
    return {
        {{"or", &avx512::CountWithOr}, {"choice", &avx512::CountWithChoice}}};
  }
  if (target == "AVX2") {
    return {{{"or", &avx2::CountWithOr}, {"choice", &avx2::CountWithChoice}}};
  }
  if (target == "SSE4") {
    return {{{"or", &sse4::CountWithOr}, {"choice", &sse4::CountWithChoice}}};
  }
#else
  (void)target;
#endif
  return {
      {{"or", &baseline::CountWithOr}, {"choice", &baseline::CountWithChoice}}};
}

}  // namespace halfspace::bench
