#include "bench/base/progress.h"

#include <cstdio>

#if defined(_WIN32)
#include <io.h>
#else
#include <unistd.h>
#endif

namespace halfspace::bench {
namespace {

bool IsStderrATerminal() {
#if defined(_WIN32)
  return _isatty(_fileno(stderr)) != 0;
#else
  return isatty(STDERR_FILENO) != 0;
#endif
}

}  // namespace

Progress::Progress(std::string_view program)
    : is_redrawn_(IsStderrATerminal()), program_(program) {}

void Progress::Plan(std::string_view section, std::size_t count,
                    double seconds) {
  seconds_.emplace(section, seconds);
  all_ += static_cast<double>(count) * seconds;
}

void Progress::Begin(std::string_view section) {
  const bool is_new = section != section_;
  if (!section_.empty()) done_ += seconds_[section_];
  section_ = section;
  const auto percent = static_cast<int>(100.0 * done_ / all_);
  if (is_redrawn_) {
    // As wide as the longest name.
    std::fprintf(stderr, "\r%-14s  %3d %%", section_.c_str(), percent);
  } else if (is_new) {
    std::fprintf(stderr, "%s: %s  %3d %%\n", program_.c_str(), section_.c_str(),
                 percent);
  }
  std::fflush(stderr);
}

void Progress::Clear() {
  if (is_redrawn_) std::fprintf(stderr, "\r%21s\r", "");
}

}  // namespace halfspace::bench
