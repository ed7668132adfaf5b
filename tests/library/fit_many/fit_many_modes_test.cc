// The caller's floating-point mode changes no bound of many.
#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "tests/library/fit/random_shapes.h"
#include "tests/library/fit_many/bulk.h"
#include "tests/library/support/environment.h"
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
      const BulkOutput usual(bulk, kShapes, arena);
      const BulkOutput built(bulk, kShapes, arena);
      for (Target target : TargetsUnderTest()) {
        for (bool is_tightest : {false, true}) {
          const FitOptions options{.tightest = is_tightest, .target = target};
          source.Bound(usual.output(), options);
          for (FpMode mode : kFpModes) {
            RunIn(mode, [&] { source.Bound(built.output(), options); });
            for (std::size_t i = 0; i < kShapes; ++i) {
              ASSERT_TRUE(SameBits(built.Get(i), usual.Get(i)))
                  << NameOf(kind) << ", " << i << ", " << target.name()
                  << ", mode " << static_cast<int>(mode);
            }
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace halfspace::testing
