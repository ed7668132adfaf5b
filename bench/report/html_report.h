// The page to look at: one file of HTML from the JSON of one or more runs.
#ifndef HALFSPACE_BENCH_REPORT_HTML_REPORT_H_
#define HALFSPACE_BENCH_REPORT_HTML_REPORT_H_

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace halfspace::bench {

// More machines have no room beside each other.
inline constexpr std::size_t kMostReports = 8;

inline constexpr std::size_t kMostPageBytes = std::size_t{2} << 20;

// Throws std::invalid_argument with what is wrong with a JSON report, whoever
// wrote it, if no page can be made of it.
void CheckReport(std::string_view json);

struct HtmlPage {
  std::string html;
  std::size_t failed_figures =
      0;  // that gnuplot, though installed, did not draw
};

// Of the texts that ToJson() gives. Throws std::invalid_argument.
HtmlPage HtmlReport(const std::vector<std::string>& reports);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_REPORT_HTML_REPORT_H_
