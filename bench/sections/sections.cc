#include "bench/sections/sections.h"

#include <array>

namespace halfspace::bench {

#define HALFSPACE_SECTION(name, run, weight, flags) Tables run(Run&);
#include "bench/sections/sections.def"
#undef HALFSPACE_SECTION

std::span<const Section> Sections() {
#define HALFSPACE_SECTION(name, run, weight, flags) \
  Section{name, run, weight, flags},
  static constexpr std::array kSections = {
#include "bench/sections/sections.def"
  };
#undef HALFSPACE_SECTION
  return kSections;
}

}  // namespace halfspace::bench
