#include "tests/library/fit/exact_answers.h"

#include <gmpxx.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "halfspace/error.h"
#include "halfspace/shapes.h"
#include "tests/library/support/exact.h"

namespace halfspace::testing {
namespace {

constexpr float kMost = std::numeric_limits<float>::max();

::testing::AssertionResult Expected(const char* what) {
  return ::testing::AssertionFailure() << "expected " << what;
}

::testing::AssertionResult Is(const Outcome& outcome, const Planes& planes,
                              const char* what) {
  if (!outcome.is_refused && outcome.planes == planes) {
    return ::testing::AssertionSuccess();
  }
  return Expected(what);
}

bool AreFinite(const Builder& builder, const Shape& shape, std::size_t begin) {
  for (std::size_t i = begin; i < builder.roles.size(); ++i) {
    if (!std::isfinite(builder.Number(shape, i))) return false;
  }
  return true;
}

// An error names the call, an argument that is wrong, and what it is.
::testing::AssertionResult IsRefusal(const Builder& builder, const Shape& shape,
                                     const Outcome& outcome, bool is_refused) {
  if (!is_refused) return Expected("no error");
  if (!outcome.is_refused) return Expected("an error");
  const std::string& message = outcome.message;
  const std::string call = "halfspace: " + std::string(builder.call) + ": ";
  const auto says = [&](const std::string& start, const std::string& end) {
    return message.starts_with(call + start) &&
           message.find(end, call.size() + start.size()) != std::string::npos;
  };
  bool is_named = false;
  for (std::size_t i = 0; i < builder.roles.size(); ++i) {
    const double number = builder.Number(shape, i);
    if (builder.roles[i] == Role::kMinimum && builder.kind != Kind::kChange) {
      const std::string axis = "[" + std::to_string(i) + "]";
      is_named |= number > builder.Number(shape, i + builder.dims) &&
                  says("box: expected min" + axis, "max" + axis);
    } else if (!(number >= 0)) {
      is_named |= says(builder.Argument(i) + ": expected a number",
                       std::isnan(number) ? "got nan" : "not negative, got -");
    }
  }
  if (is_named) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "the error is \"" << message << '"';
}

// Builders.

bool IsRound(const Builder& builder) {
  return builder.kind == Kind::kSphere || builder.kind == Kind::kCapsule;
}

}  // namespace

mpq_class WeightOf(const Builder& builder, Shape shape) {
  for (float& number : shape.floats) number = std::fabs(number);
  for (double& number : shape.doubles) number = std::fabs(number);
  mpq_class radius = 0;
  if (IsRound(builder)) {
    const std::size_t last = builder.roles.size() - 1;
    radius = Exact(builder.Number(shape, last));
    shape.Set(last, 0);
  }
  mpq_class most = 0;
  for (std::size_t i = 0; i < builder.results(); ++i) {
    const mpq_class weight = -HullOf(builder, shape, i).LowestD();
    if (weight > most) most = weight;
  }
  return most + radius;
}

namespace {

::testing::AssertionResult IsExactBound(const Builder& builder,
                                        const Shape& shape,
                                        const Outcome& outcome) {
  bool is_refused = false;
  bool is_inverted = false;
  bool is_empty = true;
  const double most =
      builder.is_double ? std::numeric_limits<double>::max() : double{kMost};
  for (std::size_t i = 0; i < builder.roles.size(); ++i) {
    const double number = builder.Number(shape, i);
    switch (builder.roles[i]) {
      case Role::kLength:
        is_refused |= !(number >= 0);
        break;
      case Role::kMinimum: {
        const double max = builder.Number(shape, i + builder.dims);
        is_inverted |= number > max;
        is_empty &= number >= most && max <= -most;
        break;
      }
      default:
        break;
    }
  }
  if (builder.kind == Kind::kBox || builder.kind == Kind::kImageOfBox) {
    if (is_empty) return Is(outcome, builder.Empty(), "Empty()");
    is_refused |= is_inverted;
  }
  if (is_refused || outcome.is_refused) {
    return IsRefusal(builder, shape, outcome, is_refused);
  }
  if (!AreFinite(builder, shape, 0)) {
    return Is(outcome, builder.Everything(), "Everything()");
  }
  // The sum of the magnitudes may be rounded.
  const mpq_class limit = Exact(0x1p125);
  const mpq_class rounding = Exact(0x1p105);
  const mpq_class weight = WeightOf(builder, shape);
  if (weight > limit + rounding) {
    return Is(outcome, builder.Everything(), "Everything(), as it is large");
  }
  if (outcome.planes == builder.Everything() && weight > limit - rounding) {
    return ::testing::AssertionSuccess();
  }
  for (std::size_t i = 0; i < builder.results(); ++i) {
    auto result = HullOf(builder, shape, i)
                      .IsEnclosedBy(&outcome.planes[i * 2 * (builder.dims + 1)],
                                    LooseBy(weight));
    if (!result) return result << ", result " << i;
  }
  return ::testing::AssertionSuccess();
}

// Changes of bounds.

bool IsMinimum(const Builder& builder, std::size_t i) {
  // The other bound of Merge() has no roles of its own.
  return builder.roles[i % builder.first_argument()] == Role::kMinimum;
}

bool IsEmptyBound(const Builder& builder, const float* planes) {
  for (std::size_t i = 0; i < builder.first_argument(); ++i) {
    if (IsMinimum(builder, i) ? !(planes[i] >= kMost)
                              : !(planes[i] <= -kMost)) {
      return false;
    }
  }
  return true;
}

bool IsValid(float plane, bool is_minimum) {
  return plane == (is_minimum ? -kMost : kMost) || std::fabs(plane) <= 0x1p126f;
}

bool IsValidBound(const Builder& builder, const float* planes) {
  for (std::size_t i = 0; i < builder.first_argument(); ++i) {
    if (!IsValid(planes[i], IsMinimum(builder, i))) return false;
  }
  return true;
}

// Beyond what can be bounded, or next to it.
bool MayOverflow(const ExactValue& value) {
  const mpq_class most = Exact(0x1p126) - Exact(0x1p103);
  return Compare({most, 0, value.n}, value) < 0 ||
         Compare({mpq_class(-most), 0, value.n}, value) > 0;
}

// What the exact move adds to a coordinate or to D.
mpq_class ShiftOf(const ExactPoint& by, std::size_t axis) {
  if (axis < by.size()) return by[axis];
  mpq_class sum = 0;
  for (const mpq_class& x : by) sum -= x;
  return sum;
}

// All but TranslateVertices() and Merge().
ExactPlanes ExactChange(const Builder& builder, const Shape& shape) {
  const std::size_t dims = builder.dims;
  const std::size_t first = builder.first_argument();
  const auto exact = [&](std::size_t i) -> std::optional<ExactValue> {
    if (std::fabs(shape.floats[i]) == kMost) return std::nullopt;
    return ExactValue(Exact(shape.floats[i]));
  };
  ExactPlanes planes(dims, builder.minima(), builder.maxima());
  ExactPoint argument;
  for (std::size_t i = first; i < builder.roles.size(); ++i) {
    argument.push_back(Exact(shape.floats[i]));
  }
  const bool is_turned =
      builder.change == Change::kScale && sgn(argument[0]) < 0;
  for (std::size_t p = 0; p < planes.values.size(); ++p) {
    const std::size_t axis = planes.Axis(p);
    const int sign = planes.IsMinimum(p) ? -1 : 1;
    auto& plane = planes.values[p];
    plane = exact(is_turned ? (p + planes.minima) % planes.values.size() : p);
    if (!plane) continue;
    switch (builder.change) {
      case Change::kInflate:
        if (axis == dims) {
          plane = ExactValue(plane->rational, sign * argument[0],
                             static_cast<int>(dims));
        } else {
          plane->rational += sign * argument[0];
        }
        break;
      case Change::kInflateByBox:
        plane->rational +=
            sign * (axis == dims ? static_cast<int>(dims) : 1) * argument[0];
        break;
      case Change::kTranslate:
        plane->rational += ShiftOf(argument, axis);
        break;
      case Change::kSweep:
        if (sgn(ShiftOf(argument, axis)) == sign) {
          plane->rational += ShiftOf(argument, axis);
        }
        break;
      case Change::kScale:
        plane->rational *= argument[0];
        break;
      case Change::kMerge:
      case Change::kTranslateVertices:
        break;
    }
  }
  return planes;
}

bool MayOverflow(const ExactPlanes& planes) {
  return std::any_of(
      planes.values.begin(), planes.values.end(),
      [](const auto& plane) { return plane && MayOverflow(*plane); });
}

Planes Merged(const Builder& builder, const Shape& shape) {
  const std::size_t count = builder.first_argument();
  const float* a = shape.floats.data();
  const float* b = a + count;
  if (IsEmptyBound(builder, a)) a = b;
  if (IsEmptyBound(builder, b)) b = a;
  if (IsEmptyBound(builder, a)) return builder.Empty();
  if (!IsValidBound(builder, a) || !IsValidBound(builder, b)) {
    return builder.Everything();
  }
  Planes merged{};
  for (std::size_t p = 0; p < count; ++p) {
    merged[p] =
        IsMinimum(builder, p) ? std::min(a[p], b[p]) : std::max(a[p], b[p]);
  }
  return merged;
}

bool IsRefusedChange(const Builder& builder, const Shape& shape) {
  const std::size_t first = builder.first_argument();
  const float argument = shape.floats[first];
  switch (builder.roles.back()) {
    case Role::kLength:
      return !(argument >= 0);
    case Role::kFactor:
      return builder.part < Part::kUp ? std::isnan(argument) : !(argument >= 0);
    default:
      return false;
  }
}

::testing::AssertionResult IsExactChange(const Builder& builder,
                                         const Shape& shape,
                                         const Outcome& outcome) {
  if (builder.change == Change::kMerge) {
    return Is(outcome, Merged(builder, shape), "the minima and the maxima");
  }
  const bool is_refused = IsRefusedChange(builder, shape);
  if (is_refused || outcome.is_refused) {
    return IsRefusal(builder, shape, outcome, is_refused);
  }
  const float* const given = shape.floats.data();
  const bool is_finite = AreFinite(builder, shape, builder.first_argument());
  const bool is_everything = outcome.planes == builder.Everything();
  if (IsEmptyBound(builder, given)) {
    return Is(outcome, builder.Empty(), "Empty()");
  }
  if (!IsValidBound(builder, given) || !is_finite) {
    return Is(outcome, builder.Everything(), "Everything()");
  }
  ExactPlanes exact = ExactChange(builder, shape);
  bool may_be_everything = MayOverflow(exact);
  if (builder.change == Change::kSweep) {
    Builder move = builder;
    move.change = Change::kTranslate;
    may_be_everything |= MayOverflow(ExactChange(move, shape));
  }
  const bool is_unbounded =
      std::none_of(exact.values.begin(), exact.values.end(),
                   [](const auto& plane) { return plane.has_value(); });
  if (is_everything) {
    if (may_be_everything || is_unbounded) {
      return ::testing::AssertionSuccess();
    }
    return Expected("a bound, not Everything()");
  }
  for (std::size_t p = 0; p < exact.values.size(); ++p) {
    const bool is_minimum = exact.IsMinimum(p);
    const float plane = outcome.planes[p];
    if (!IsValid(plane, is_minimum)) {
      return Expected("no plane beyond what can be bounded");
    }
    // A plane of its own may give up.
    if (exact.values[p] && MayOverflow(*exact.values[p]) &&
        plane == (is_minimum ? -kMost : kMost)) {
      exact.values[p].reset();
    }
  }
  mpq_class weight = 0;
  for (std::size_t i = 0; i < builder.roles.size(); ++i) {
    const float number = shape.floats[i];
    if (std::fabs(number) != kMost) weight += 4 * abs(Exact(number));
  }
  return exact.AreTightIn(outcome.planes.data(), LooseBy(weight));
}

}  // namespace

Outcome Try(const Builder& builder, const Shape& shape,
            const FitStatus& before) {
  Outcome outcome;
  outcome.status = before;
  try {
    outcome.planes = builder.Build(shape, &outcome.status);
  } catch (const Error& error) {
    outcome.is_refused = true;
    outcome.message = error.what();
  }
  return outcome;
}

::testing::AssertionResult IsExact(const Builder& builder, const Shape& shape,
                                   const Outcome& outcome) {
  const std::size_t results = outcome.is_refused ? 0 : builder.results();
  const bool is_everything =
      !outcome.is_refused && outcome.planes == builder.Everything();
  if (outcome.status.results != kCountedBefore + results ||
      outcome.status.everything != (is_everything ? results : 0) ||
      outcome.status.first_everything != (is_everything ? kCountedBefore : 0)) {
    return Expected("another status");
  }
  return builder.kind == Kind::kChange ? IsExactChange(builder, shape, outcome)
                                       : IsExactBound(builder, shape, outcome);
}

void SetPlanesOfVertices(const Builder& builder, const Shape& vertices,
                         Shape& shape) {
  const std::size_t dims = builder.dims;
  const Planes bound = BuilderOf(Kind::kTriangle, dims).Build(vertices);
  for (std::size_t p = 0; p < builder.first_argument(); ++p) {
    const bool skips_d = builder.part == Part::kAabb && p >= dims;
    shape.Set(p, bound[skips_d ? p + 1 : p]);
  }
}

::testing::AssertionResult EnclosesMovedVertices(const Builder& builder,
                                                 const Shape& vertices,
                                                 const Shape& shape,
                                                 const Outcome& outcome) {
  const std::size_t dims = builder.dims;
  const std::size_t first = builder.first_argument();
  const Builder& points = BuilderOf(Kind::kTriangle, dims);
  const Planes everything = points.Everything();
  const Planes& result = outcome.planes;
  if (!AreFinite(builder, shape, first) ||
      points.Build(vertices) == everything) {
    return Is(outcome, builder.Everything(), "Everything()");
  }
  Shape moved = vertices;
  bool is_large = false;
  for (std::size_t i = 0; i < 3 * dims; ++i) {
    const float by = shape.floats[first + i % dims];
    moved.Set(i, vertices.floats[i] + by);
    is_large |=
        std::fabs(by) > 0x1p120f || std::fabs(vertices.floats[i]) > 0x1p120f;
  }
  if (result == builder.Everything()) {
    return is_large ? ::testing::AssertionSuccess() : Expected("a bound");
  }
  const Planes expected = points.Build(moved);
  if (expected == everything) return ::testing::AssertionSuccess();
  if (builder.part == Part::kAabb) {
    for (std::size_t p = 0; p < first; ++p) {
      if (result[p] != expected[p >= dims ? p + 1 : p]) {
        return Expected("the box of the moved vertices");
      }
    }
    return ::testing::AssertionSuccess();
  }
  const ExactHull hull = HullOf(points, moved);
  auto encloses = hull.IsEnclosedBy(result.data(), {.floats = kAnyFloats});
  if (!encloses) return encloses;
  // D may give way by what rounding can do to the largest coordinates, by what
  // the sums in double lose, and round once; it was rounded when the bound was
  // made.
  mpq_class give = 0;
  ExactPoint by;
  for (std::size_t k = 0; k < dims; ++k) {
    give +=
        Exact(std::max(std::fabs(result[k]), std::fabs(result[dims + 1 + k])));
    by.push_back(Exact(shape.floats[first + k]));
  }
  give *= Exact(0x1.00001p-24);
  for (const mpq_class& x : by) give += abs(x) * Exact(0x1p-46);
  for (std::size_t p : {dims, 2 * dims + 1}) {
    give += abs(Exact(shape.floats[p])) * Exact(0x1p-46);
  }
  const mpq_class shift = ShiftOf(by, dims);
  const mpq_class low = Exact(shape.floats[dims]) + shift - give;
  const mpq_class high = Exact(shape.floats[2 * dims + 1]) + shift + give;
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  if (std::nextafter(result[dims], kInfinity) < low ||
      std::nextafter(result[2 * dims + 1], -kInfinity) > high) {
    return Expected("a tighter D");
  }
  return ::testing::AssertionSuccess();
}

}  // namespace halfspace::testing
