#include "bench/base/progress.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string_view>

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

bool HasEscapeSequences() {
  const char* term = std::getenv("TERM");
  return term != nullptr && *term != '\0' && std::string_view(term) != "dumb";
}

bool IsColorWanted() {
  const char* no_color = std::getenv("NO_COLOR");
  return no_color == nullptr || *no_color == '\0';
}

}  // namespace

Progress::Progress()
    : is_redrawn_(IsStderrATerminal() && HasEscapeSequences()),
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
  if (is_redrawn_) {
    Update(0.0);
  } else {
    Print((program_ + ": ").c_str(), "", 0.0);
    std::fputc('\n', stderr);
  }
}

void Progress::BeginPart(std::size_t part, std::size_t parts) {
  part_ = static_cast<double>(part);
  parts_ = static_cast<double>(parts);
  Update(0.0);
}

void Progress::Update(double fraction) {
  if (!is_redrawn_) return;
  const Clock::time_point now = Clock::now();
  if (now - last_draw_ < std::chrono::milliseconds(100)) return;
  last_draw_ = now;
  Print(has_color_ ? "\r\033[K\033[1m" : "\r\033[K",
        has_color_ ? "\033[0m" : "", fraction);
  is_line_drawn_ = true;
}

void Progress::Print(const char* before, const char* after,
                     double fraction) const {
  const double of_section = (part_ + std::clamp(fraction, 0.0, 1.0)) / parts_;
  const double done = std::min(1.0, (before_ + weight_ * of_section) / total_);
  const double elapsed =
      std::chrono::duration<double>(Clock::now() - start_).count();
  std::fprintf(stderr, "%s%s%s  %3.0f %%", before, section_.c_str(), after,
               100.0 * done);
  // Too early, the estimate is noise.
  if (done > 0.02) {
    const int left = static_cast<int>(elapsed / done - elapsed);
    std::fprintf(stderr, ", %d:%02d left", left / 60, left % 60);
  }
  std::fflush(stderr);
}

void Progress::Clear() {
  if (!is_line_drawn_) return;
  std::fputs("\r\033[K", stderr);
  std::fflush(stderr);
  is_line_drawn_ = false;
}

}  // namespace halfspace::bench
