// The list of sections of a program. A section measures or counts, and returns
// tables.
#ifndef HALFSPACE_BENCH_SECTIONS_SECTIONS_H_
#define HALFSPACE_BENCH_SECTIONS_SECTIONS_H_

#include <span>
#include <string_view>

#include "bench/report/table.h"

namespace halfspace::bench {

class Run;

// Flags: the page has the section; it measures the scene, unless there is a
// file; or the scene in any case; it reads what other sections leave in Run; it
// reads the verdict.
inline constexpr unsigned kPage = 1;
inline constexpr unsigned kScene = 2;
inline constexpr unsigned kPaperScene = 4;
inline constexpr unsigned kLast = 8;
inline constexpr unsigned kVerdict = 16;

struct Section {
  std::string_view name;
  Tables (*run)(Run& run);
  double weight;  // its share of the progress line
  unsigned flags;
};

// A program is this library and its list of sections.
struct Program {
  const char* name;
  const char* what;  // for --help
  std::span<const Section> sections;
};

// The one that is linked: its sections.cc defines it.
const Program& ThisProgram();

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_SECTIONS_SECTIONS_H_
