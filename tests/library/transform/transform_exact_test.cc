// Changes of bounds against the exact planes.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "halfspace/fit.h"
#include "tests/library/fit/builders.h"
#include "tests/library/fit/exact_shapes.h"
#include "tests/library/fit/random_shapes.h"

namespace halfspace::testing {
namespace {

// What the exact move adds to a coordinate or to D.
mpq_class ShiftOf(const ExactPoint& by, std::size_t axis) {
  if (axis < by.size()) return by[axis];
  mpq_class sum = 0;
  for (const mpq_class& x : by) sum -= x;
  return sum;
}

// All but TranslateVertices().
ExactPlanes ExactChange(const Builder& builder, const Shape& shape) {
  constexpr float kMost = detail::kMax<float>;
  const std::size_t dims = builder.dims;
  const std::size_t first = builder.first_argument();
  const auto exact = [&](std::size_t i) -> std::optional<ExactValue> {
    if (std::fabs(shape.floats[i]) == kMost) return std::nullopt;
    return ExactValue(Exact(shape.floats[i]));
  };
  ExactPlanes planes(dims, builder.minima(), builder.maxima());
  const mpq_class argument = Exact(shape.floats[first]);
  ExactPoint move;
  for (std::size_t k = 0; k < dims; ++k) {
    move.push_back(Exact(shape.floats[first + k]));
  }
  const bool is_turned = builder.change == Change::kScale && sgn(argument) < 0;
  for (std::size_t p = 0; p < planes.values.size(); ++p) {
    const std::size_t axis = planes.Axis(p);
    const int sign = planes.IsMinimum(p) ? -1 : 1;
    auto& plane = planes.values[p];
    plane = exact(is_turned ? (p + planes.minima) % planes.values.size() : p);
    if (builder.change == Change::kCircumscribe) {
      // The planes of the axes sum to zero: on each, what the others leave.
      plane = ExactValue(0);
      for (std::size_t k = 0; k < first; ++k) {
        const auto other = exact(k);
        if (k == axis || !plane) continue;
        if (!other) {
          plane.reset();
        } else {
          plane->rational -= other->rational;
        }
      }
      continue;
    }
    if (!plane) continue;
    switch (builder.change) {
      case Change::kMerge: {
        const auto other = exact(first + p);
        if (!other || Compare(*other, *plane) * sign > 0) plane = other;
        break;
      }
      case Change::kInflate:
        if (axis == dims) {
          plane = ExactValue(plane->rational, sign * argument,
                             static_cast<int>(dims));
        } else {
          plane->rational += sign * argument;
        }
        break;
      case Change::kInflateByBox:
        plane->rational +=
            sign * (axis == dims ? static_cast<int>(dims) : 1) * argument;
        break;
      case Change::kTranslate:
        plane->rational += ShiftOf(move, axis);
        break;
      case Change::kSweep:
        if (sgn(ShiftOf(move, axis)) == sign) {
          plane->rational += ShiftOf(move, axis);
        }
        break;
      case Change::kScale:
        plane->rational *= argument;
        break;
      case Change::kTranslateVertices:
      case Change::kCircumscribe:
        break;
    }
  }
  return planes;
}

class TransformExactTest : public ::testing::TestWithParam<Builder> {};

TEST_P(TransformExactTest, EnclosesAndIsAsTightAsPromised) {
  const Builder& builder = GetParam();
  const Looseness loose =
      builder.change == Change::kInflate ? Looseness{.d = 1} : kTightest;
  ForEachSample(50, 200, 1, [&](PointKind kind, Random& random) {
    const Shape shape = RandomShape(builder, kind, random);
    const Planes planes = builder.Build(shape);
    ASSERT_TRUE(ExactChange(builder, shape).AreTightIn(planes.data(), loose));
  });
}

std::vector<Builder> ExactChanges() {
  std::vector<Builder> changes = Changes();
  std::erase_if(changes, [](const Builder& builder) {
    return builder.change == Change::kTranslateVertices;
  });
  return changes;
}
INSTANTIATE_TEST_SUITE_P(, TransformExactTest,
                         ::testing::ValuesIn(ExactChanges()), BuilderNames());

class TranslateVerticesTest : public ::testing::TestWithParam<Builder> {};

// Against vertices that are really moved, and rounded.
TEST_P(TranslateVerticesTest, EnclosesMovedVertices) {
  const Builder& builder = GetParam();
  const std::size_t dims = builder.dims;
  const Builder& points = BuilderOf(Kind::kTriangle, dims);
  const std::size_t first = builder.first_argument();
  const bool is_box = builder.part == Part::kAabb;
  std::size_t exact_moves_that_cut = 0;
  ForEachSample(60, 300, 1, [&](PointKind kind, Random& random) {
    Shape vertices = RandomShape(points, kind, random);
    const Planes bound = points.Build(vertices);
    Shape shape = RandomShape(builder, kind, random);
    ExactPoint by;
    for (std::size_t k = 0; k < dims; ++k) {
      if (kind == PointKind::kCancelling) {
        shape.Set(first + k, shape.floats[first + k] + vertices.floats[k]);
      }
      by.push_back(Exact(shape.floats[first + k]));
    }
    for (std::size_t p = 0; p < first; ++p) {
      shape.Set(p, bound[is_box && p >= dims ? p + 1 : p]);
    }
    for (std::size_t i = 0; i < 3 * dims; ++i) {
      vertices.Set(i, vertices.floats[i] + shape.floats[first + i % dims]);
    }
    const Planes moved = builder.Build(shape);
    if (is_box) {
      const Planes expected = points.Build(vertices);
      for (std::size_t p = 0; p < first; ++p) {
        ASSERT_EQ(moved[p], expected[p >= dims ? p + 1 : p]);
      }
      return;
    }
    const ExactHull hull = HullOf(points, vertices);
    ASSERT_TRUE(hull.IsEnclosedBy(moved.data(), {.d = kAnyFloats}));
    // D may give way by what rounding can do to the largest coordinates, and
    // round once; it was rounded when the bound was made.
    mpq_class give = 0;
    for (std::size_t k = 0; k < dims; ++k) {
      give +=
          Exact(std::max(std::fabs(moved[k]), std::fabs(moved[dims + 1 + k])));
    }
    give *= Exact(0x1p-24);
    const mpq_class low = Exact(bound[dims]) + ShiftOf(by, dims) - give;
    const mpq_class high =
        Exact(bound[2 * dims + 1]) + ShiftOf(by, dims) + give;
    ASSERT_GE(std::nextafter(moved[dims], detail::kInf<float>), low);
    ASSERT_LE(std::nextafter(moved[2 * dims + 1], -detail::kInf<float>), high);
    Builder exact_move = builder;
    exact_move.change = Change::kTranslate;
    exact_moves_that_cut +=
        !hull.IsEnclosedBy(exact_move.Build(shape).data(),
                           {.coordinates = kAnyFloats, .d = kAnyFloats});
  });
  // Otherwise the other call would do.
  EXPECT_TRUE(is_box || exact_moves_that_cut > 0);
}

TEST_P(TranslateVerticesTest, PlanesWithoutABoundStaySo) {
  const Builder& builder = GetParam();
  ForEachSample(61, 100, 1, [&](PointKind kind, Random& random) {
    const Shape shape = RandomShape(builder, kind, random);
    const Planes moved = builder.Build(shape);
    for (std::size_t p = 0; p < builder.first_argument(); ++p) {
      const float plane = shape.floats[p];
      if (std::fabs(plane) == detail::kMax<float>) {
        ASSERT_EQ(moved[p], plane);
      }
    }
  });
}

std::vector<Builder> VertexChanges() {
  std::vector<Builder> changes = Changes();
  std::erase_if(changes, [](const Builder& builder) {
    return builder.change != Change::kTranslateVertices;
  });
  return changes;
}
INSTANTIATE_TEST_SUITE_P(, TranslateVerticesTest,
                         ::testing::ValuesIn(VertexChanges()), BuilderNames());

}  // namespace
}  // namespace halfspace::testing
