#include "bench/sections/sections.h"

namespace halfspace::bench {

#define HALFSPACE_SECTION(name, run, weight, flags) Tables run(Run&);
#include "bench/sections/sections.def"
#undef HALFSPACE_SECTION

const Program& ThisProgram() {
#define HALFSPACE_SECTION(name, run, weight, flags) \
  Section{name, run, weight, flags},
  static constexpr Section kSections[] = {
#include "bench/sections/sections.def"
  };
#undef HALFSPACE_SECTION
  static constexpr Program kProgram = {
      "cpuinfo-bench",
      "Measures on this machine when a bounding simplex rejects faster than a "
      "box,\nand when it does not.",
      kSections};
  return kProgram;
}

}  // namespace halfspace::bench
