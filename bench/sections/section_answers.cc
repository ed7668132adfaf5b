#include <algorithm>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "bench/report/report_parts.h"
#include "bench/sections/sections.h"

namespace halfspace::bench {
namespace {

using IsOneOf = std::function<bool(const Way&)>;

bool IsSorted(const Way& way) { return way.schedule == "sorted"; }
bool IsQuantized(const Way& way) { return way.precision != "floats"; }

// The fastest of some ways; null if there is none of them.
const Way* FastestOf(const SweepCell& cell, const IsOneOf& is_one) {
  const Way* fastest = nullptr;
  for (const Way& way : cell.ways) {
    if (is_one(way) &&
        (fastest == nullptr || way.ns_with_exact < fastest->ns_with_exact)) {
      fastest = &way;
    }
  }
  return fastest;
}

// The better of two ways, by their times with exact tests. `name` says of a way
// what is asked for.
Answer Better(const char* question, const Way& one, const Way& other,
              const std::function<std::string(const Way&)>& name) {
  const bool is_one = one.ns_with_exact <= other.ns_with_exact;
  const Way& better = is_one ? one : other;
  const Way& worse = is_one ? other : one;
  const Ratio ratio = RatioOf(worse.samples, better.samples);
  Answer answer{question, "", ratio, ratio.low <= 1.0};
  answer.text = answer.is_tie
                    ? "no difference between " + name(better) + " and " +
                          name(worse) + ": " + RatioText(ratio) + " times"
                    : name(better) + ", " + RatioText(ratio) +
                          " times as fast as " + name(worse);
  return answer;
}

std::vector<Answer> AnswersOf(const SweepCell& own) {
  std::vector<Answer> answers;
  const Way& best = own.ways[own.best];
  const auto add = [&answers](const char* question, const Way* one,
                              const Way* other, const auto& name) {
    if (one != nullptr && other != nullptr) {
      answers.push_back(Better(question, *one, *other, name));
    }
  };
  add("shape", &best,
      FastestOf(own,
                [&best](const Way& way) { return way.shape != best.shape; }),
      [](const Way& way) { return way.name(); });
  const Way* scan = FastestOf(
      own, [](const Way& way) { return !IsSorted(way) && !IsQuantized(way); });
  const Way* other =
      scan == nullptr ? nullptr : FastestOf(own, [scan](const Way& way) {
        return !IsSorted(way) && !IsQuantized(way) &&
               way.schedule != scan->schedule;
      });
  add("schedule", scan, other,
      [](const Way& way) { return way.schedule + " (" + way.shape + ")"; });
  const Way* quantized = FastestOf(own, IsQuantized);
  add("precision", quantized, scan,
      [](const Way& way) { return way.precision + " (" + way.shape + ")"; });
  const Way* any_scan =
      FastestOf(own, [](const Way& way) { return !IsSorted(way); });
  add("structure", FastestOf(own, IsSorted), any_scan, [](const Way& way) {
    return IsSorted(way) ? "a sorted world (" + way.shape + ")"
                         : "a scan (" + way.name() + ")";
  });
  return answers;
}

// The fastest number of threads above one, of each work.
std::vector<Answer> ThreadsAnswers(const ThreadsResult& threads) {
  std::vector<const ThreadsRow*> fastest;
  for (const ThreadsRow& row : threads.rows) {
    if (row.threads == 1) continue;
    if (fastest.empty() || fastest.back()->work != row.work) {
      fastest.push_back(&row);
    } else if (row.ns_per_pair < fastest.back()->ns_per_pair) {
      fastest.back() = &row;
    }
  }
  std::vector<Answer> answers;
  for (const ThreadsRow* row : fastest) {
    const std::string times =
        std::to_string(row->threads) + " threads, " + RatioText(row->times);
    Answer answer{"threads", row->work + ": ", row->times,
                  row->times.low <= 1.0 && row->times.high >= 1.0};
    answer.text +=
        answer.is_tie ? "no difference between one and " + times + " times"
        : row->times.high < 1.0
            ? "one, or other programs use the CPUs: " + times + " times as fast"
            : times + " times as fast as one";
    answers.push_back(answer);
  }
  return answers;
}

}  // namespace

AnswersResult MakeAnswers(const Results& results) {
  AnswersResult result;
  if (results.sweep) {
    result.answers = AnswersOf(results.sweep->own);
  } else {
    result.not_reached.push_back(
        "shape, schedule, precision, structure: run "
        "the section sweep too");
  }
  if (results.threads) {
    for (Answer& answer : ThreadsAnswers(*results.threads)) {
      result.answers.push_back(std::move(answer));
    }
  }
  const auto add = [&result](const std::vector<std::string>& more) {
    result.not_reached.insert(result.not_reached.end(), more.begin(),
                              more.end());
  };
  if (results.crossover) add(results.crossover->not_reached);
  if (results.threads) add(results.threads->not_reached);
  return result;
}

}  // namespace halfspace::bench
