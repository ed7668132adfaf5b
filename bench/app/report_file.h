// The reports of --against and --render.
#ifndef HALFSPACE_BENCH_APP_REPORT_FILE_H_
#define HALFSPACE_BENCH_APP_REPORT_FILE_H_

#include <stdexcept>
#include <string>

#include "bench/input/input_error.h"
#include "bench/input/input_file.h"
#include "bench/report/report_field.h"

namespace halfspace::bench {

// What `use` makes of the text of a report. Throws InputError, also for a
// std::invalid_argument of `use`.
template <typename Use>
auto ReadReport(const std::string& path, const Use& use) {
  // One byte more than a report can have, so that it is not cut.
  const std::string text = ReadBytes(path, kMostReportBytes + 1);
  try {
    return use(text);
  } catch (const std::invalid_argument& error) {
    throw InputError(path, error.what(),
                     "give a file that --format json --out has written");
  }
}

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_APP_REPORT_FILE_H_
