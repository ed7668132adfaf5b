// The parts of the page, as HTML. Texts of a report are escaped here.
#ifndef HALFSPACE_BENCH_REPORT_HTML_PARTS_H_
#define HALFSPACE_BENCH_REPORT_HTML_PARTS_H_

#include <string>
#include <string_view>
#include <vector>

#include "bench/report/report_field.h"

namespace halfspace::bench {

// For text and for attributes in double quotes; control characters and what is
// longer than a line of a report are replaced.
std::string Escaped(std::string_view text);

// <name>text</name>
std::string Element(const std::string& name, std::string_view text);

// The first row is the header, which may be empty; the first column names the
// rows.
std::string HtmlTable(const std::vector<std::vector<std::string>>& rows);

// Anything, as lines and tables: what has no form of its own.
std::string HtmlOf(const Json& value);

// Of `sweep`: the simplex's time over the AABB's by width and overlap, and the
// fastest by size and number of objects. Empty if there is none.
std::string RatioMap(const ReportField& sweep);
std::string FastestTable(const ReportField& sweep);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_REPORT_HTML_PARTS_H_
