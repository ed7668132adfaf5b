#include "bench/sections/run.h"

#if defined(HALFSPACE_BENCH_PAPER)
#define HALFSPACE_SECTIONS "bench/paper/sections.def"
#else
#define HALFSPACE_SECTIONS "bench/sections/sections.def"
#endif

namespace halfspace::bench {

#define HALFSPACE_SECTION(name, run, seconds, flags) Tables run(Run&);
#include HALFSPACE_SECTIONS
#undef HALFSPACE_SECTION

const Program& ThisProgram() {
#define HALFSPACE_SECTION(name, run, seconds, flags) \
  Section{name, run, seconds, flags},
  static constexpr Section kSections[] = {
#include HALFSPACE_SECTIONS
  };
#undef HALFSPACE_SECTION
#if defined(HALFSPACE_BENCH_PAPER)
  static constexpr Program kProgram = {
      "paper-bench",
      "Repeats the experiments of \"The Bounding Simplex: A SIMD-Era Rejection "
      "Primitive\".",
      kSections};
#else
  static constexpr Program kProgram = {
      "cpuinfo-bench",
      "Measures on this machine when a bounding simplex rejects faster than a "
      "box,\nand when it does not.",
      kSections};
#endif
  return kProgram;
}

}  // namespace halfspace::bench
