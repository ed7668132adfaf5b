// Says on stderr which section of a long run is measured, and after how much of
// the time that the run takes on a common machine: on a terminal in one line
// that is drawn again, elsewhere in a line for each section.
#ifndef HALFSPACE_BENCH_BASE_PROGRESS_H_
#define HALFSPACE_BENCH_BASE_PROGRESS_H_

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <string_view>

namespace halfspace::bench {

class Progress {
 public:
  explicit Progress(std::string_view program);
  ~Progress() { Clear(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // `count` sections of this name take `seconds` each.
  void Plan(std::string_view section, std::size_t count, double seconds);

  // Starts a section, and ends the section before.
  void Begin(std::string_view section);

  // Removes the line of a terminal, so that other output can follow.
  void Clear();

 private:
  bool is_redrawn_;
  std::string program_;
  std::string section_;
  std::map<std::string, double, std::less<>> seconds_;  // of a section
  double done_ = 0.0;
  double all_ = 0.0;
};

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_BASE_PROGRESS_H_
