// The list of sections. A section measures or counts, and returns tables.
#ifndef HALFSPACE_BENCH_SECTIONS_SECTIONS_H_
#define HALFSPACE_BENCH_SECTIONS_SECTIONS_H_

#include <span>
#include <string_view>

#include "bench/report/table.h"

namespace halfspace::bench {

class Run;

// Flags: the page has the section; it measures the scene, unless there is a
// file; or the scene in any case; it reads what other sections leave in Run.
inline constexpr unsigned kPage = 1;
inline constexpr unsigned kScene = 2;
inline constexpr unsigned kPaperScene = 4;
inline constexpr unsigned kLast = 8;

struct Section {
  std::string_view name;
  Tables (*run)(Run& run);
  double weight;  // its share of the progress line
  unsigned flags;
};

// From sections.def.
std::span<const Section> Sections();

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_SECTIONS_SECTIONS_H_
