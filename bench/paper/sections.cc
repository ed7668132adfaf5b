#include "bench/sections/sections.h"

namespace halfspace::bench {

#define HALFSPACE_SECTION(name, run, weight, flags) Tables run(Run&);
#include "bench/paper/sections.def"
#undef HALFSPACE_SECTION

const Program& ThisProgram() {
#define HALFSPACE_SECTION(name, run, weight, flags) \
  Section{name, run, weight, flags},
  static constexpr Section kSections[] = {
#include "bench/paper/sections.def"
  };
#undef HALFSPACE_SECTION
  static constexpr Program kProgram = {
      "paper-bench",
      "Repeats the experiments of \"The Bounding Simplex: A SIMD-Era Rejection "
      "Primitive\".",
      kSections};
  return kProgram;
}

}  // namespace halfspace::bench
