// Bounds of shapes and of bounds, by any row of the builders, against exact
// arithmetic.
#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "tests/fuzz/fuzz.h"
#include "tests/library/fit/builders.h"
#include "tests/library/fit/exact_answers.h"
#include "tests/library/fit/random_shapes.h"
#include "tests/library/support/fp_modes.h"

namespace halfspace::testing {

void Fuzz(Random& random) {
  static const std::vector<Builder> rows = [] {
    std::vector<Builder> all = Builders({2, 3, 4});
    for (const Builder& change : Changes({2, 3, 4})) all.push_back(change);
    return all;
  }();
  const Builder& builder = OneOf(rows, random);
  const PointKind kind = OneOf(kPointKinds, random);
  const FpMode mode = kFpModes[random() % 5];  // a signalling NaN may trap
  Shape shape = RandomShape(builder, kind, random);
  Spoil(builder, shape, random);
  const bool moves_vertices = builder.kind == Kind::kChange &&
                              builder.change == Change::kTranslateVertices;
  const Builder& points = BuilderOf(Kind::kTriangle, builder.dims);
  Shape vertices = RandomShape(points, kind, random);
  if (moves_vertices) {
    Spoil(points, vertices, random);
    SetPlanesOfVertices(builder, vertices, shape);
  }
  Outcome outcome;
  RunIn(mode, [&] { outcome = Try(builder, shape); });
  EXPECT_TRUE(moves_vertices
                  ? EnclosesMovedVertices(builder, vertices, shape, outcome)
                  : IsExact(builder, shape, outcome))
      << builder << ", mode " << static_cast<int>(mode) << ", floats "
      << ::testing::PrintToString(shape.floats) << ", doubles "
      << ::testing::PrintToString(shape.doubles);
}

}  // namespace halfspace::testing
