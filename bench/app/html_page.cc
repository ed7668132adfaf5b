#include "bench/app/html_page.h"

#include <iostream>
#include <sstream>

#include "bench/app/report_file.h"
#include "bench/base/write_whole.h"
#include "bench/report/html_report.h"
#include "bench/report/report.h"

namespace halfspace::bench {

void WriteHtml(OutFile& file, const std::vector<std::string>& reports) {
  const HtmlPage page = HtmlReport(reports);
  if (page.failed_figures > 0) {
    std::cerr << "cpuinfo-bench: gnuplot failed; the page has tables in place "
                 "of "
              << page.failed_figures << " figures\n";
  }
  file.Write(page.html);
}

int Render(const BenchOptions& options) {
  std::vector<std::string> reports;
  for (const std::string& path : options.render) {
    reports.push_back(ReadReport(path, [](const std::string& text) {
      CheckReport(text);
      std::ostringstream page;
      WritePage(page, text);
      return text;
    }));
  }
  if (options.report.empty()) {
    for (const std::string& report : reports) {
      if (&report != &reports.front()) std::cout << '\n';
      WriteWhole(std::cout, [&](std::ostream& out) { WritePage(out, report); });
    }
  } else {
    OutFile file(options.report);
    WriteHtml(file, reports);
  }
  return kExitOk;
}

}  // namespace halfspace::bench
