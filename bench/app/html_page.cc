#include "bench/app/html_page.h"

#include <fstream>
#include <iostream>
#include <sstream>
#include <stdexcept>

#include "bench/input/input_error.h"
#include "bench/report/html_report.h"
#include "bench/report/report.h"

namespace halfspace::bench {
namespace {

constexpr const char* kOther =
    "give a file that --format json --out has written";

// No more of it than a report can have.
std::string ReadReport(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text;
  char part[1 << 16];
  while (text.size() <= kMostReportBytes &&
         (file.read(part, sizeof(part)) || file.gcount() > 0)) {
    text.append(part, static_cast<std::size_t>(file.gcount()));
  }
  if (!file.is_open() || file.bad()) {
    throw InputError(path, "cannot be read", kOther);
  }
  try {
    CheckReport(text);
    std::ostringstream page;
    WritePage(page, text);
  } catch (const std::invalid_argument& error) {
    throw InputError(path, error.what(), kOther);
  }
  return text;
}

}  // namespace

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
    reports.push_back(ReadReport(path));
  }
  if (options.report.empty()) {
    for (const std::string& report : reports) {
      if (&report != &reports.front()) std::cout << '\n';
      WritePage(std::cout, report);
    }
  } else {
    OutFile file(options.report);
    WriteHtml(file, reports);
  }
  return kExitOk;
}

}  // namespace halfspace::bench
