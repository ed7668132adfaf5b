#include "bench/app/out_file.h"

#include <random>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace halfspace::bench {

namespace fs = std::filesystem;

namespace {

// Whether writing `output` replaces `other`. A pipe or a device has nothing to
// lose.
bool WouldReplace(const fs::path& output, const fs::path& other) {
  std::error_code error;
  return fs::is_regular_file(output, error) &&
         fs::equivalent(output, other, error);
}

}  // namespace

void CheckOutputs(const BenchOptions& options) {
  const std::pair<std::string, std::string> inputs[] = {
      {"--mesh", options.mesh},
      {"--bounds", options.bounds},
      {"--query-bounds", options.query_bounds}};
  for (const auto& [option, path] : inputs) {
    if (options.out.empty() || path.empty()) continue;
    if (WouldReplace(options.out, path)) {
      throw UsageError("--out " + options.out +
                       " would overwrite the file of " + option + " " + path +
                       "; name another file");
    }
  }
}

OutFile::OutFile(const std::string& path)
    : path_(path), target_(path), part_(path) {
  std::error_code error;
  const fs::file_status old = fs::status(path, error);
  bool is_writable = true;
  if (fs::exists(old)) {
    // Appending leaves it as it is.
    file_.open(path, std::ios::app);
    is_writable = file_.is_open();
  }
  if (!fs::exists(old) || fs::is_regular_file(old)) {
    const fs::path real = fs::canonical(path, error);
    if (!error) target_ = real;
    part_ = target_;
    part_ += "." + std::to_string(std::random_device()()) + ".part";
    file_.close();
    file_.open(part_);
    is_writable = is_writable && file_.is_open();
    file_.close();
    fs::remove(part_, error);
  }
  if (!is_writable) {
    throw UsageError(path + ": cannot be written; choose another file");
  }
}

void OutFile::Write(std::string_view text) {
  std::error_code error;
  const bool is_replaced = part_ != target_;
  if (is_replaced) file_.open(part_);
  file_ << text;
  file_.close();
  if (!file_) {
    if (is_replaced) fs::remove(part_, error);
    throw std::runtime_error(path_ + ": writing failed; is the disk full?");
  }
  if (!is_replaced) return;
  const fs::file_status old = fs::status(target_, error);
  if (fs::exists(old)) fs::permissions(part_, old.permissions(), error);
  fs::rename(part_, target_, error);
  if (error) {
    throw std::runtime_error(path_ +
                             ": cannot be replaced: " + error.message() +
                             "; the results are in " + part_.string());
  }
}

}  // namespace halfspace::bench
