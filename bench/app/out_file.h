// The file of --out: replaced as a whole at the end, so that whatever
// ends a run before leaves what was there.
#ifndef HALFSPACE_BENCH_APP_OUT_FILE_H_
#define HALFSPACE_BENCH_APP_OUT_FILE_H_

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "bench/sections/options.h"

namespace halfspace::bench {

// Throws UsageError if the file to write is also a file to read, under any of
// its names.
void CheckOutputs(const BenchOptions& options);

class OutFile {
 public:
  // Throws UsageError if nothing can be written there: before the run rather
  // than after it.
  explicit OutFile(const std::string& path);

  // Called once. Throws std::runtime_error.
  void Write(std::string_view text);

 private:
  std::string path_;              // as it was given
  std::filesystem::path target_;  // where links lead
  // Written beside the target, and then renamed. A pipe or a device, which must
  // not be replaced, is the target itself.
  std::filesystem::path part_;
  std::ofstream file_;
};

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_APP_OUT_FILE_H_
