#include "bench/base/progress.h"

#include <algorithm>
#include <cmath>
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

void Estimate::Plan(std::string_view kind, std::size_t count, double guess) {
  Kind& planned = kinds_[std::string(kind)];
  planned.left += count;
  planned.guess = guess;
}

void Estimate::Begin(std::string_view kind, double now) {
  End(now);
  current_ = &kinds_[std::string(kind)];
  if (current_->left > 0) --current_->left;
}

void Estimate::Update(double fraction, double now) {
  fraction = std::min(fraction, 1.0);
  if (fraction <= fraction_) return;
  fraction_ = fraction;
  updated_ = now;
}

void Estimate::End(double now) {
  if (current_ != nullptr) {
    // The latest part counts as much as all before it: a pace changes.
    const double seconds = now - start_;
    current_->seconds =
        current_->is_timed ? (current_->seconds + seconds) / 2.0 : seconds;
    current_->is_timed = true;
    guessed_ += current_->guess;
    seconds_ += seconds;
  }
  current_ = nullptr;
  start_ = now;
  fraction_ = 0.0;
}

double Estimate::Expected(const Kind& kind) const {
  if (kind.is_timed) return kind.seconds;
  double guessed = guessed_;
  double seconds = seconds_;
  if (current_ != nullptr && fraction_ > 0.0) {
    guessed += fraction_ * current_->guess;
    seconds += updated_ - start_;
  }
  return guessed > 0.0 ? kind.guess * seconds / guessed : kind.guess;
}

double Estimate::Left(double now) const {
  double left = 0.0;
  for (const auto& [name, kind] : kinds_) {
    left += static_cast<double>(kind.left) * Expected(kind);
  }
  if (current_ == nullptr) return left;
  double whole = Expected(*current_);
  if (fraction_ > 0.0) {
    // The more of the part is done, the more its own pace counts.
    const double share = std::min(1.0, 10.0 * fraction_);
    whole += share * ((updated_ - start_) / fraction_ - whole);
  }
  // A part that is late takes some time more.
  const double elapsed = now - start_;
  return left + std::max(whole - elapsed, 0.01 * std::max(whole, elapsed));
}

double Estimate::Done(double now) {
  const double left = Left(now);
  if (now + left > 0.0) done_ = std::max(done_, now / (now + left));
  return done_;
}

Progress::Progress()
    : is_redrawn_(IsStderrATerminal() && HasEscapeSequences()),
      has_color_(IsColorWanted()),
      start_(Clock::now()) {}

Progress::~Progress() { Clear(); }

void Progress::Begin(std::string_view section) {
  estimate_.Begin(section, Now());
  part_ = 0.0;
  parts_ = 0.0;
  const bool is_new = section != section_;
  section_ = section;
  if (is_redrawn_) {
    Draw();
  } else if (is_new) {
    Print((program_ + ": ").c_str(), "");
    std::fputc('\n', stderr);
  }
}

void Progress::BeginPart(std::size_t part, std::size_t parts) {
  part_ = static_cast<double>(part);
  parts_ = static_cast<double>(parts);
  Update(0.0);
}

void Progress::Update(double fraction) {
  if (parts_ > 0.0) {
    estimate_.Update((part_ + std::clamp(fraction, 0.0, 1.0)) / parts_, Now());
  }
  if (!is_redrawn_) return;
  if (Clock::now() - last_draw_ < std::chrono::milliseconds(100)) return;
  Draw();
}

void Progress::End() {
  estimate_.End(Now());
  if (is_redrawn_) Draw();
}

double Progress::Now() const {
  return std::chrono::duration<double>(Clock::now() - start_).count();
}

void Progress::Draw() {
  last_draw_ = Clock::now();
  Print(has_color_ ? "\r\033[K\033[1m" : "\r\033[K",
        has_color_ ? "\033[0m" : "");
  is_line_drawn_ = true;
}

void Progress::Print(const char* before, const char* after) {
  const double now = Now();
  const auto percent = static_cast<int>(100.0 * estimate_.Done(now));
  std::fprintf(stderr, "%s%s%s  %3d %%", before, section_.c_str(), after,
               percent);
  if (estimate_.is_timed()) {
    const int left = static_cast<int>(std::lround(estimate_.Left(now)));
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
