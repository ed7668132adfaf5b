#include "tests/library/support/answers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "tests/library/support/calls.h"
#include "tests/library/support/target_that_runs.h"

namespace halfspace::testing {
namespace {

// Before a call, so that what it writes shows.
template <typename T>
std::span<T> Unwritten(std::span<T> output) {
  std::fill(output.begin(), output.end(), Canaried<T>::kCanary);
  return output;
}

void CompareCallsOfOne(const Answers& answers, const AnyWorld& world,
                       const AnyQueries& query, const Options& options,
                       const Outputs& outputs, Differences& compare) {
  const auto asked = [&] { return world.Asked(query); };
#if !defined(__EMSCRIPTEN__)  // where doubles have no kernels but plain code
  const Target target =
      options.target == Target() ? ChosenTarget() : options.target;
  if (const Target ran = TargetThatRuns(world, query, options); ran != target) {
    compare.Add("CountSurvivors", "ran on " + std::string(ran.name()));
  }
#endif
  detail::RejectMask(asked(), Unwritten(outputs.words), options);
  compare.Find<std::uint64_t>("RejectMask", answers.rejected(), outputs.words);
  detail::SurvivorMask(asked(), outputs.words, options);
  compare.Find<std::uint64_t>("SurvivorMask", answers.survived(),
                              outputs.words);

  const auto all = answers.survivors();
  compare.Find("Survivors", all.size(),
               detail::Survivors(asked(), outputs.objects, options, 0));
  compare.Find<std::uint32_t>("Survivors", all, outputs.objects);
  compare.Find("CountSurvivors", all.size(),
               detail::CountSurvivors(asked(), options));
  compare.Find("AnySurvivor", all.empty() ? detail::kNoSurvivor : all.front(),
               detail::AnySurvivor(asked(), options));
  std::vector<std::uint32_t> seen;
  const auto add = [&](Span<const std::uint32_t> some) {
    seen.insert(seen.end(), some.begin(), some.end());
  };
  detail::Callback call{add};
  detail::ForEachSurvivor(asked(), &decltype(call)::Run, &call, options);
  compare.Find("ForEachSurvivor", all.size(), seen.size());
  seen.resize(all.size());
  compare.Find<std::uint32_t>("ForEachSurvivor", all, seen);
}

// Pairs come in any order, but those of one query in ascending order.
std::string WhatIsWrong(const Answers& answers, const Outputs& pairs) {
  std::vector<std::size_t> seen(answers.queries());
  for (std::size_t j = 0; j < answers.survivors().size(); ++j) {
    const std::uint32_t q = pairs.queries[j];
    if (q >= seen.size() || seen[q] == answers.survivors(q).size() ||
        answers.survivors(q)[seen[q]++] != pairs.objects[j]) {
      return "pair " + std::to_string(j) + " is query " + std::to_string(q) +
             ", object " + std::to_string(pairs.objects[j]);
    }
  }
  return {};
}

}  // namespace

Answers Answers::OfReference(const AnyWorld& world, const AnyQueries& queries,
                             const Range& range) {
  const std::size_t words = MaskWords(world.size());
  std::vector<std::uint64_t> rows(queries.count * words);
  for (std::size_t q = 0; q < queries.count; ++q) {
    world.ReferenceMask(world.One(queries, q),
                        std::span(rows).subspan(q * words, words));
  }
  return {world.size(), queries.count, range, rows};
}

Answers Answers::OfCall(const AnyWorld& world, const AnyQueries& queries,
                        Target target, const Range& range) {
  std::vector<std::uint64_t> rows(queries.count * MaskWords(world.size()));
  detail::SurvivorMasks(world.Asked(queries), rows,
                        {.schedule = Schedule::kFlat, .target = target}, 0);
  for (std::uint64_t& word : rows) word = ~word;
  return {world.size(), queries.count, range, rows};
}

::testing::AssertionResult CallsAnswer(const Answers& answers,
                                       const AnyWorld& world,
                                       const AnyQueries& queries,
                                       const Options& options,
                                       const Outputs& outputs) {
  Differences compare(options);
  if (queries.count == 1) {
    CompareCallsOfOne(answers, world, queries, options, outputs, compare);
  }
  const auto asked = [&] { return world.Asked(queries); };
  detail::SurvivorMasks(asked(), Unwritten(outputs.words), options, 0);
  compare.Find<std::uint64_t>("SurvivorMasks", answers.survived(),
                              outputs.words);
  if (world.HasUnchecked() && options.schedule == Schedule::kAuto &&
      options.range.begin == 0 && options.range.end >= world.size()) {
    for (bool is_one : {false, true}) {
      if (is_one && queries.count != 1) continue;
      world.UncheckedMasks(queries, is_one, Unwritten(outputs.words),
                           options.target);
      compare.Find<std::uint64_t>("Kernels", answers.survived(), outputs.words);
    }
  }

  const std::size_t pairs =
      detail::SurvivorPairs(asked(), Unwritten(outputs.queries),
                            Unwritten(outputs.objects), options, 0);
  compare.Find("SurvivorPairs", answers.survivors().size(), pairs);
  compare.Add("SurvivorPairs", WhatIsWrong(answers, outputs));
  detail::SurvivorCounts(asked(), outputs.counts, options);
  for (std::size_t q = 0; q < queries.count; ++q) {
    compare.Find("SurvivorCounts", answers.survivors(q).size(),
                 outputs.counts[q]);
  }
  return compare.first();
}

::testing::AssertionResult AnswersEverywhere(
    const Answers& answers, const AnyWorld& world, const AnyQueries& queries,
    std::span<const Target> targets, std::span<const Schedule> schedules) {
  // Outputs with more room than is needed, that notice a write into it.
  constexpr std::size_t kMore = 5;
  thread_local CallOutputs memory;
  const std::size_t words = answers.rejected().size();
  const std::size_t pairs = answers.survivors().size();
  for (Target target : targets) {
    for (Schedule schedule : schedules) {
      const Options options{
          .schedule = schedule, .target = target, .range = answers.range()};
      const Outputs outputs = {memory.words.Reset(words + kMore),
                               memory.indices.Reset(pairs + kMore),
                               memory.query_indices.Reset(pairs + kMore),
                               memory.counts.Reset(answers.queries() + kMore)};
      auto result = CallsAnswer(answers, world, queries, options, outputs);
      if (!result) return result;
      if (!memory.IntactBut(words, pairs, answers.queries())) {
        return Differences(options).Say("a call") << "wrote past its output";
      }
    }
  }
  return ::testing::AssertionSuccess();
}

::testing::AssertionResult QuantizedAnswersEverywhere(
    const AnyWorld& quantized, const AnyWorld& refined, const Answers& exact,
    const AnyQueries& queries, std::span<const Target> targets) {
  const Answers of_quantized =
      Answers::OfCall(quantized, queries, targets[0], exact.range());
  for (std::size_t w = 0; w < exact.survived().size(); ++w) {
    if ((exact.survived()[w] & of_quantized.rejected()[w]) == 0) continue;
    return ::testing::AssertionFailure()
           << "quantized bounds reject an object of word " << w
           << ", which floats keep";
  }
  auto result = AnswersEverywhere(of_quantized, quantized, queries, targets);
  if (!result) return result << " (quantized alone)";
  result = AnswersEverywhere(exact, refined, queries, targets);
  if (!result) return result << " (refined)";
  return result;
}

}  // namespace halfspace::testing
