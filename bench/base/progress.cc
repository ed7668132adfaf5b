#include "bench/base/progress.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

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

bool IsColorWanted() {
  const char* no_color = std::getenv("NO_COLOR");
  return no_color == nullptr || *no_color == '\0';
}

}  // namespace

Progress::Progress()
    : is_shown_(IsStderrATerminal()),
      has_color_(IsColorWanted()),
      start_(Clock::now()) {}

Progress::~Progress() { Clear(); }

void Progress::Begin(std::string_view section, double weight) {
  before_ += weight_;
  weight_ = weight;
  part_ = 0.0;
  parts_ = 1.0;
  section_ = section;
  last_draw_ = {};
  Update(0.0);
}

void Progress::BeginPart(std::size_t part, std::size_t parts) {
  part_ = static_cast<double>(part);
  parts_ = static_cast<double>(parts);
  Update(0.0);
}

void Progress::Update(double fraction) {
  if (!is_shown_) return;
  const Clock::time_point now = Clock::now();
  if (now - last_draw_ < std::chrono::milliseconds(100)) return;
  last_draw_ = now;
  const double of_section = (part_ + std::clamp(fraction, 0.0, 1.0)) / parts_;
  const double done = std::min(1.0, (before_ + weight_ * of_section) / total_);
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  std::fprintf(stderr, "\r\033[K%s%s%s  %3.0f %%", has_color_ ? "\033[1m" : "",
               section_.c_str(), has_color_ ? "\033[0m" : "", 100.0 * done);
  // Too early, the estimate is noise.
  if (done > 0.02) {
    const int left = static_cast<int>(elapsed / done - elapsed);
    std::fprintf(stderr, ", %d:%02d left", left / 60, left % 60);
  }
  std::fflush(stderr);
  is_line_drawn_ = true;
}

void Progress::Clear() {
  if (!is_line_drawn_) return;
  std::fputs("\r\033[K", stderr);
  std::fflush(stderr);
  is_line_drawn_ = false;
}

}  // namespace halfspace::bench
