// Contestants that answer the same questions, timed beside each other: the
// library and competitors. Each answer is checked before it is timed.
#ifndef HALFSPACE_BENCH_SECTIONS_CONTEST_H_
#define HALFSPACE_BENCH_SECTIONS_CONTEST_H_

#include <algorithm>
#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "bench/measure/measure.h"
#include "bench/report/table.h"
#include "bench/sections/run.h"

namespace halfspace::bench {

enum class Who { kOurs, kCompetitor };

class Contest {
 public:
  // `place` is the beginning of the names of all cases, which are one group.
  Contest(Run& run, std::string place) : run_(run), place_(std::move(place)) {}

  // `target` is empty for what is none of the library's.
  void Add(std::string name, std::string target, Who who, Case c) {
    c.name = place_ + "/" + name + (target.empty() ? "" : "/" + target);
    c.group = place_;
    cases_.push_back(std::move(c));
    names_.push_back(std::move(name));
    targets_.push_back(std::move(target));
    if (who == Who::kCompetitor) competitors_.push_back(cases_.size() - 1);
  }

  // Each call of run() is a repetition.
  void Time(std::size_t repetitions) {
    timings_ = run_.Time(cases_, {repetitions, 0.0});
    for (std::size_t c : competitors_) {
      if (timings_[c].Median() < timings_[fastest_].Median() ||
          c == competitors_.front()) {
        fastest_ = c;
      }
    }
  }

  // Of the contestants, in the order in which they were added.
  std::size_t size() const { return cases_.size(); }
  const std::string& name(std::size_t i) const { return names_[i]; }
  const std::string& target(std::size_t i) const { return targets_[i]; }
  const Timing& timing(std::size_t i) const { return timings_[i]; }
  // How many times as fast as the fastest competitor; empty without one.
  Cell OverFastest(std::size_t i) const {
    if (competitors_.empty()) return {};
    return RatioOf(timings_[fastest_], timings_[i]);
  }

 private:
  Run& run_;
  std::string place_;
  std::vector<std::string> names_;
  std::vector<std::string> targets_;
  std::vector<Case> cases_;
  std::vector<std::size_t> competitors_;
  std::vector<Timing> timings_;
  std::size_t fastest_ = 0;  // of the competitors
};

// The parts of a section, one after the other. Each ends with what it holds.
using Parts = std::vector<std::function<void()>>;
inline void RunParts(Run& run, Parts& parts) {
  for (std::size_t i = 0; i < parts.size(); ++i) {
    run.progress.BeginPart(i, parts.size());
    parts[i]();
    parts[i] = nullptr;
  }
}

// The sizes up to `most`; if none, that one.
inline std::vector<std::size_t> UpTo(std::size_t most,
                                     std::vector<std::size_t> sizes) {
  std::erase_if(sizes, [most](std::size_t size) { return size > most; });
  if (sizes.empty()) sizes.push_back(most);
  return sizes;
}

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_SECTIONS_CONTEST_H_
