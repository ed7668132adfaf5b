// Worlds of floats and doubles: every target and every call against the oracle,
// bit for bit.
#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "tests/fuzz/fuzz.h"
#include "tests/library/support/answers.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/flat_cases.h"

namespace halfspace::testing {
namespace {

// Of a few words, and around the tiles of staged scans.
std::size_t SomeSize(Random& random) {
  const std::size_t tiles = random() % 8;
  return random() % 512 + (tiles > 2 ? 0 : tiles * 4096 - 64 * (tiles > 0));
}

}  // namespace

void Fuzz(Random& random) {
  static const std::vector<FlatCase> rows = AllFlatCases();
  static const std::vector<Target> targets = TargetsUnderTest();
  const FlatCase& row = OneOf(rows, random);
  const std::size_t size = SomeSize(random);
  const InputKind kind = OneOf(kInputKinds, random);
  const Schedule schedule = OneOf(kSchedules, random);
  const std::size_t count = random() % 2 == 0 ? 1 : random() % 20;
  // Planes are misaligned, or end where their blocks do.
  const std::size_t misalignments = random() % 2 == 0 ? 1 : 16;
  const std::size_t offset = random() % misalignments;
  const FlatInput input(row, kind, size + misalignments - 1, random);
  const FlatQueries queries(row, input, count, random);
  const AnyWorld world = input.WorldAt(offset, size, misalignments);
  const AnyQueries asked = queries.Some(0, count);
  const Range range =
      random() % 4 == 0 ? Range{random() % (size + 1), size} : Range{};
  EXPECT_TRUE(AnswersEverywhere(Answers::OfReference(world, asked, range),
                                world, asked, targets, {&schedule, 1}))
      << row << ", " << NameOf(kind) << ", " << size << " objects, " << count
      << " queries, from " << range.begin << ", offset " << offset;
}

}  // namespace halfspace::testing
