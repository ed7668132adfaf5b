// What the sections of the text report have in common.
#ifndef HALFSPACE_BENCH_REPORT_REPORT_PARTS_H_
#define HALFSPACE_BENCH_REPORT_REPORT_PARTS_H_

#include <ostream>
#include <string>
#include <vector>

#include "bench/base/text_table.h"
#include "bench/report/results.h"

namespace halfspace::bench {

inline void Heading(std::ostream& out, const char* name,
                    const std::string& what) {
  out << '\n' << name << ": " << what << "\n\n";
}

// The median, and the quartiles in brackets.
inline std::string RatioText(const Ratio& ratio, int digits = 2) {
  return Fixed(ratio.median, digits) + " [" + Fixed(ratio.low, digits) + ", " +
         Fixed(ratio.high, digits) + "]";
}

inline void WriteNotReached(std::ostream& out,
                            const std::vector<std::string>& not_reached) {
  for (const std::string& reason : not_reached) {
    out << "  not reached: " << reason << '\n';
  }
}

// The aims, and how many of them are met. `missed` follows where one is not.
void WriteRatios(std::ostream& out, const std::vector<ThroughputRatio>& ratios,
                 const char* missed);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_REPORT_REPORT_PARTS_H_
