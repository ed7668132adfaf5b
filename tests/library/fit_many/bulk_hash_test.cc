// One constant per builder of many bounds that stands for its bounds of many
// seeded shapes, in every layout.
#include <gtest/gtest.h>

#include <cstddef>
#include <string>

#include "tests/library/fit_many/bulk.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/fnv_hash.h"
#include "tests/library/support/known_hashes.h"
#include "tests/library/support/seeded_numbers.h"

namespace halfspace::testing {
namespace {

constexpr std::size_t kShapes = 5 * 64 + 37;

// Some boxes are inverted, some spheres have no radius.
BulkShapes SeededShapes(const Bulk& bulk) {
  SeededNumbers numbers(bulk.dims);
  BulkShapes shapes(kShapes);
  for (auto& shape : shapes) {
    const Builder& single = bulk.single();
    const Shape seeded = SeededShape(single, numbers);
    for (std::size_t i = 0; i < single.roles.size(); ++i) {
      shape.push_back(single.Number(seeded, i));
    }
    const std::uint32_t kind = numbers.Below(32);
    if (bulk.kind == Kind::kPoints) shape.resize(kind % 4 * bulk.dims);
    if (kind == 0 && !bulk.IsOfPoints()) std::swap(shape[0], shape.back());
  }
  return shapes;
}

TEST(BulkHashTest, IsTheSameEverywhere) {
  for (const Bulk& bulk : Bulks()) {
    BulkSource source(bulk, SeededShapes(bulk));
    for (const FitOptions& way : {FitOptions{}, FitOptions{.tightest = true},
                                  FitOptions{.inverted = Inverted::kEmpty}}) {
      for (BulkLayout layout : kBulkLayouts) {
        Arena arena;
        source.Place(arena, layout);
        const BulkOutput built(bulk, kShapes, arena);
        for (Target target : TargetsUnderTest()) {
          FitOptions options = way;
          options.target = target;
          FitStatus status;
          source.Bound(built.output(), options, &status);
          FnvHash hash;
          for (std::size_t i = 0; i < kShapes; ++i) {
            hash.AddAllFloats(built.Get(i));
          }
          hash.Add(status.results);
          hash.Add(status.everything);
          hash.Add(status.first_everything);
          EXPECT_LT(status.everything, status.results / 4);
          EXPECT_TRUE(IsKnown(
              bulk.name + (way.tightest ? "Tightest" : "") +
                  (way.inverted == Inverted::kEmpty ? "InvertedAreEmpty" : ""),
              hash.value()))
              << target.name() << ", layout " << static_cast<int>(layout);
        }
      }
    }
  }
}

}  // namespace
}  // namespace halfspace::testing
