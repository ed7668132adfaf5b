#include <algorithm>
#include <cstddef>
#include <string>

#include "bench/base/text_table.h"
#include "bench/report/report.h"
#include "bench/report/report_parts.h"

namespace halfspace::bench {

void WriteText(std::ostream& out, const ThroughputResult& result) {
  Heading(out, "throughput", "ns per object and query, beside its ceiling");
  TextTable rows({"what", "set", "target", "ceiling", "objects", "queries",
                  "ns/pair", "% of it"});
  for (const ThroughputRow& row : result.rows) {
    rows.AddRow({row.name, row.working_set,
                 row.target.empty() ? "-" : row.target,
                 row.ceiling ? result.rows[*row.ceiling].name : "-",
                 Grouped(row.objects), Grouped(row.queries),
                 Fixed(row.ns_per_pair, 4), Fixed(row.percent_of_ceiling, 0)});
  }
  rows.Write(out, 4);
  if (result.survivors) {
    out << "\n  survivors on the grid: aabb " << Grouped(result.survivors->aabb)
        << ", aabo " << Grouped(result.survivors->aabo) << ", simplex "
        << Grouped(result.survivors->simplex) << '\n';
  }
  out << '\n';
  WriteRatios(out, result.ratios,
              " One that is missed is no failure, and no wrong answer;\n  "
              "docs/performance.md has those known, and why.");
  WriteNotReached(out, result.not_reached);
}

void WriteRatios(std::ostream& out, const std::vector<ThroughputRatio>& ratios,
                 const char* missed) {
  TextTable table({"threshold", "ratio", "", "value", "aim"});
  for (const ThroughputRatio& ratio : ratios) {
    table.AddRow(
        {std::to_string(ratio.threshold), ratio.name,
         ratio.is_met() ? "met" : "missed", Fixed(ratio.value, 2),
         (ratio.is_higher_better ? ">= " : "<= ") + Fixed(ratio.needed, 2)});
  }
  table.Write(out, 3);
  const auto met = std::count_if(
      ratios.begin(), ratios.end(),
      [](const ThroughputRatio& ratio) { return ratio.is_met(); });
  const auto all = static_cast<std::ptrdiff_t>(ratios.size());
  if (all != 0) {
    out << "\n  " << met << " of " << all << " aims are met.";
    if (met != all) out << missed;
    out << '\n';
  }
}

}  // namespace halfspace::bench
