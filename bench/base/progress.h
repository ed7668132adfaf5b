// Says on stderr how far a long run is, and how long it still takes: on a
// terminal in one line that is drawn again and again, elsewhere, and on a
// terminal that has no escape sequences (TERM=dumb), in a line for each
// section. No colours with NO_COLOR.
#ifndef HALFSPACE_BENCH_BASE_PROGRESS_H_
#define HALFSPACE_BENCH_BASE_PROGRESS_H_

#include <chrono>
#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <string_view>

namespace halfspace::bench {

// Estimates how far a run is, from the times of its parts. All parts of a kind
// take about as long. Times are seconds since the run began.
class Estimate {
 public:
  // The run has `count` more parts of a kind. A part takes `guess`, times the
  // pace of the parts that are over, until one of its kind is over.
  void Plan(std::string_view kind, std::size_t count, double guess);

  // Starts a planned part, and ends the part before.
  void Begin(std::string_view kind, double now);
  // At least `fraction` of the current part is done.
  void Update(double fraction, double now);
  // Ends the run.
  void End(double now);

  // Whether Left() is more than a guess.
  bool is_timed() const { return guessed_ > 0.0 || fraction_ > 0.05; }
  double Left(double now) const;
  // From 0 to 1 at the end. It never decreases.
  double Done(double now);

 private:
  struct Kind {
    std::size_t left = 0;  // parts that have not begun
    double guess = 0.0;
    bool is_timed = false;
    double seconds = 0.0;  // of a part, if one is over
  };

  // The seconds of a part.
  double Expected(const Kind& kind) const;

  std::map<std::string, Kind, std::less<>> kinds_;
  Kind* current_ = nullptr;
  double start_ = 0.0;     // of the current part
  double fraction_ = 0.0;  // of it,
  double updated_ = 0.0;   // which was done at that time
  double done_ = 0.0;
  // Sums over the parts that are over.
  double guessed_ = 0.0;
  double seconds_ = 0.0;
};

class Progress {
 public:
  Progress();
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void SetProgram(std::string_view program) { program_ = program; }

  // `count` sections of this name will take `guess` seconds each.
  void Plan(std::string_view section, std::size_t count, double guess) {
    estimate_.Plan(section, count, guess);
  }

  // Starts a section.
  void Begin(std::string_view section);

  // From now on, and until the section ends, Update() is about one of `parts`
  // equal parts of it, counted from 0.
  void BeginPart(std::size_t part, std::size_t parts);

  // `fraction` of the part is done. Without a part, only the clock counts: the
  // section may measure again.
  void Update(double fraction);

  // Ends the run.
  void End();

  // Removes the line of a terminal, so that other output can follow.
  void Clear();

 private:
  using Clock = std::chrono::steady_clock;

  double Now() const;
  void Draw();
  // The section, between `before` and `after`, and how far the run is.
  void Print(const char* before, const char* after);

  bool is_redrawn_;
  bool has_color_;
  bool is_line_drawn_ = false;
  std::string program_;
  std::string section_;
  Estimate estimate_;
  double part_ = 0.0;   // parts of the section that are over,
  double parts_ = 0.0;  // of all parts; 0: unknown
  Clock::time_point start_;
  Clock::time_point last_draw_;
};

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_BASE_PROGRESS_H_
