// The answers of the page, and what makes a run noisy, from hand-made results.
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "bench/sections/sections.h"

namespace halfspace::bench {
namespace {

Way WayOf(std::string shape, std::string schedule, std::string precision,
          std::vector<double> samples) {
  Way way;
  way.shape = std::move(shape);
  way.schedule = std::move(schedule);
  way.precision = std::move(precision);
  way.ns_with_exact = samples[1];
  way.samples = std::move(samples);
  return way;
}

// Times of three repetitions. The octahedron's sorted world is best.
Results Measured() {
  Results results;
  results.sweep.emplace().own.ways = {
      WayOf("simplex", "flat", "floats", {30, 30, 30}),
      WayOf("aabb", "flat", "floats", {60, 60, 60}),
      WayOf("aabb", "staged", "floats", {39, 40, 41}),
      WayOf("aabo", "flat", "uint8", {14, 15, 16}),
      WayOf("aabo", "sorted", "floats", {5, 5, 5}),
      WayOf("aabb", "sorted", "floats", {4.9, 5.1, 5.1})};
  results.sweep->own.best = 4;
  results.threads.emplace().rows = {{"cache", 1, 1.0, {1.0, 1.0, 1.0}},
                                    {"cache", 2, 0.5, {2.0, 1.9, 2.1}},
                                    {"memory", 1, 1.0, {1.0, 1.0, 1.0}},
                                    {"memory", 2, 1.1, {0.9, 0.9, 0.9}}};
  return results;
}

TEST(AnswersTest, CompareTheBestWithTheBestOfTheOthers) {
  const std::vector<Answer> answers = MakeAnswers(Measured()).answers;
  ASSERT_EQ(answers.size(), 6u);

  // 4.9 / 5, 5.1 / 5, 5.1 / 5: the lower quartile is 1.
  EXPECT_EQ(answers[0].question, "shape");
  EXPECT_DOUBLE_EQ(answers[0].times.median, 5.1 / 5);
  EXPECT_TRUE(answers[0].is_tie);
  EXPECT_EQ(answers[0].text.find("no difference"), 0u) << answers[0].text;

  // Of float scans the simplex is fastest, and flat; the box is staged.
  EXPECT_EQ(answers[1].question, "schedule");
  EXPECT_DOUBLE_EQ(answers[1].times.median, 40.0 / 30);
  EXPECT_EQ(answers[1].text,
            "flat (simplex), 1.33 [1.32, 1.35] times as fast as staged (aabb)");

  // The fastest float scan is the simplex.
  EXPECT_EQ(answers[2].question, "precision");
  EXPECT_DOUBLE_EQ(answers[2].times.median, 2.0);
  EXPECT_EQ(answers[2].text.find("uint8 (aabo), 2.00"), 0u) << answers[2].text;

  EXPECT_EQ(answers[3].question, "structure");
  EXPECT_DOUBLE_EQ(answers[3].times.median, 3.0);
  EXPECT_EQ(answers[3].text.find("a sorted world (aabo), 3.00"), 0u)
      << answers[3].text;

  EXPECT_EQ(answers[4].question, "threads");
  EXPECT_DOUBLE_EQ(answers[4].times.median, 2.0);
  EXPECT_EQ(answers[4].text,
            "cache: 2 threads, 2.00 [1.90, 2.10] times as fast as one");
  EXPECT_EQ(answers[5].question, "threads");
  EXPECT_DOUBLE_EQ(answers[5].times.median, 0.9);
  EXPECT_FALSE(answers[5].is_tie);
  EXPECT_EQ(answers[5].text,
            "memory: one, or other programs use the CPUs: 2 threads, 0.90 "
            "[0.90, 0.90] times as fast");
}

TEST(AnswersTest, ThreadsWhoseQuartilesHoldOneAreATie) {
  Results results;
  results.threads.emplace().rows = {{"cache", 1, 1.0, {1.0, 1.0, 1.0}},
                                    {"cache", 2, 0.9, {1.1, 0.9, 1.2}}};
  const std::vector<Answer> answers = MakeAnswers(results).answers;
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_TRUE(answers[0].is_tie);
  EXPECT_EQ(answers[0].text,
            "cache: no difference between one and 2 threads, 1.10 [0.90, 1.20] "
            "times");
}

TEST(AnswersTest, SayWhatIsMissing) {
  const AnswersResult result = MakeAnswers(Results());
  EXPECT_TRUE(result.answers.empty());
  ASSERT_EQ(result.not_reached.size(), 1u);
  EXPECT_NE(result.not_reached[0].find("section sweep"), std::string::npos);
}

TEST(NoiseTest, IsBeyondTheLimit) {
  const auto is_noisy = [](double low, double high, double drift) {
    return NoiseResult{{1.0, low, high}, drift, 0.05}.is_noisy();
  };
  EXPECT_FALSE(is_noisy(0.96, 1.04, 0.04));
  EXPECT_TRUE(is_noisy(0.94, 1.04, 0.04));
  EXPECT_TRUE(is_noisy(0.96, 1.06, 0.04));
  EXPECT_TRUE(is_noisy(0.96, 1.04, 0.06));
}

}  // namespace
}  // namespace halfspace::bench
