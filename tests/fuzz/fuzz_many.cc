// The bulk builders against the builders of one shape, on every target, from
// and into memory of any alignment. fuzz_fit compares those with exact
// arithmetic.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "tests/fuzz/fuzz.h"
#include "tests/library/fit_many/bulk.h"
#include "tests/library/fit_many/bulk_answers.h"
#include "tests/library/support/fp_modes.h"

namespace halfspace::testing {
namespace {

// A few, of which some have spoiled numbers, again and again.
BulkShapes SomeShapesOf(const Bulk& bulk, Random& random) {
  BulkShapes distinct =
      RandomShapes(bulk, OneOf(kPointKinds, random), 4, random);
  for (auto& shape : distinct) SpoilOne(bulk, shape, random);
  BulkShapes shapes(random() % 150);
  for (auto& shape : shapes) shape = distinct[random() % 4];
  return shapes;
}

}  // namespace

void Fuzz(Random& random) {
  static const std::vector<Bulk> rows = Bulks();
  const Bulk& bulk = OneOf(rows, random);
  const FpMode mode = kFpModes[random() % 5];  // a signalling NaN may trap
  const BulkLayout layout = OneOf(kBulkLayouts, random);
  const auto wanted =
      static_cast<std::uint32_t>(random() % 4 == 0 ? random() : 0xFF);
  const FitOptions options{
      .inverted = random() % 2 == 0 ? Inverted::kEmpty : Inverted::kEverything};
  Arena arena(random() % 16, Arena::kFiniteCanary);
  const BulkShapes shapes = SomeShapesOf(bulk, random);
  BulkAnswers answers(bulk, shapes, options);
  BulkSource source(bulk, shapes);
  if (bulk.kind == Kind::kTriangle && !shapes.empty() && random() % 2 == 0) {
    // A corner of a triangle that does not exist.
    const std::size_t corner = random() % source.indices.size();
    source.indices[corner] =
        static_cast<std::uint32_t>(source.indices.size() + random() % 65536);
    answers.Set(corner / 3, bulk.single().Everything());
  }
  source.Place(arena, layout);
  EXPECT_TRUE(answers.Check(source, arena, wanted, mode))
      << bulk << ", layout " << static_cast<int>(layout) << ", planes "
      << wanted << ", mode " << static_cast<int>(mode) << ", shapes "
      << ::testing::PrintToString(shapes);
}

}  // namespace halfspace::testing
