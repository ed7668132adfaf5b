// Says on stderr how far a long run is, and how long it still takes: on a
// terminal in one line that is drawn again and again, elsewhere, and on a
// terminal that has no escape sequences (TERM=dumb), in a line for each
// section. No colours with NO_COLOR.
#ifndef HALFSPACE_BENCH_BASE_PROGRESS_H_
#define HALFSPACE_BENCH_BASE_PROGRESS_H_

#include <chrono>
#include <cstddef>
#include <string>
#include <string_view>

namespace halfspace::bench {

class Progress {
 public:
  Progress();
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // The run of a program as planned: the weights of all sections, in any unit.
  void Plan(std::string_view program, double total_weight) {
    program_ = program;
    total_ = total_weight;
  }

  // Starts a section that will take `weight` of the plan.
  void Begin(std::string_view section, double weight);

  // From now on, and until the section ends, Update() is about one of `parts`
  // equal parts of it, counted from 0.
  void BeginPart(std::size_t part, std::size_t parts);

  // `fraction` of the current section, or of its part, is done.
  void Update(double fraction);

  // Removes the line of a terminal, so that other output can follow.
  void Clear();

 private:
  using Clock = std::chrono::steady_clock;

  // The section, between `before` and `after`, and how far the run is.
  void Print(const char* before, const char* after, double fraction) const;

  bool is_redrawn_;
  bool has_color_;
  bool is_line_drawn_ = false;
  std::string program_;
  std::string section_;
  double total_ = 1.0;
  double before_ = 0.0;  // weight of the sections that are over
  double weight_ = 0.0;  // weight of the current one
  double part_ = 0.0;    // parts of it that are over, of all parts
  double parts_ = 1.0;
  Clock::time_point start_;
  Clock::time_point last_draw_;
};

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_BASE_PROGRESS_H_
