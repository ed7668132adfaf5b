// The caller's floating-point mode changes no bound of many.
#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "tests/library/fit/random_shapes.h"
#include "tests/library/fit_many/bulk.h"
#include "tests/library/fit_many/bulk_answers.h"
#include "tests/library/support/fp_modes.h"

namespace halfspace::testing {
namespace {

TEST(FitManyModesTest, NoBoundChanges) {
  constexpr std::size_t kShapes = 70;  // a tile and a tail
  for (const Bulk& bulk : Bulks()) {
    SCOPED_TRACE(bulk.name);
    Random random(9);
    for (PointKind kind : kPointKinds) {
      BulkShapes shapes;
      for (std::size_t i = 0; i < kShapes; ++i) {
        const Shape shape = RandomShape(bulk.single(), kind, random);
        const auto* const numbers = shape.doubles.data();
        shapes.emplace_back(numbers, numbers + bulk.single().roles.size());
      }
      Arena arena;
      BulkSource source(bulk, shapes);
      source.Place(arena, BulkLayout::kPacked);
      for (bool is_tightest : {false, true}) {
        BulkAnswers answers(bulk, shapes, {.tightest = is_tightest});
        for (FpMode mode : kFpModes) {
          ASSERT_TRUE(answers.Check(source, arena, 0xFFFFFFFF, mode))
              << NameOf(kind) << ", mode " << static_cast<int>(mode);
        }
      }
    }
  }
}

}  // namespace
}  // namespace halfspace::testing
