// What the rows of builders.h enclose, exactly, and what the library may answer
// for any shape. This is one property of all builders: tests try it on seeded
// shapes, and a fuzzer on its bytes.
#ifndef HALFSPACE_TESTS_LIBRARY_FIT_EXACT_ANSWERS_H_
#define HALFSPACE_TESTS_LIBRARY_FIT_EXACT_ANSWERS_H_

#include <gmpxx.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "halfspace/fit_status.h"
#include "tests/library/fit/builders.h"
#include "tests/library/support/exact.h"

namespace halfspace::testing {

using ExactPoint = std::vector<mpq_class>;

// How many floats a bound may be looser than the tightest one of what is looser
// by a slack.
struct Looseness {
  int floats = 0;
  double slack = 0.0;
};

// Of the builders of single bounds: what the sums in double may lose, if this
// is the sum of the magnitudes of their terms.
inline Looseness LooseBy(const mpq_class& weight) {
  return {.slack = 0x1p-46 * weight.get_d() + 0x1p-900};
}

// The exact planes of a bound, all minima, then all maxima. Nothing stands for
// a plane without a bound.
struct ExactPlanes {
  ExactPlanes(std::size_t its_dims, std::size_t its_minima,
              std::size_t its_maxima)
      : dims(its_dims), minima(its_minima), values(its_minima + its_maxima) {}

  bool IsMinimum(std::size_t p) const { return p < minima; }
  // 0 is X.
  std::size_t Axis(std::size_t p) const {
    return IsMinimum(p) ? p : p - minima;
  }

  ::testing::AssertionResult AreTightIn(const float* bound,
                                        Looseness loose) const {
    const auto [floats, slack] = loose;
    for (std::size_t p = 0; p < values.size(); ++p) {
      const float unbounded = std::numeric_limits<float>::max();
      auto result = ::testing::AssertionSuccess();
      if (!values[p]) {
        if (bound[p] == (IsMinimum(p) ? -unbounded : unbounded)) continue;
        result = ::testing::AssertionFailure() << "bounds the unbounded";
      } else {
        result = IsMinimum(p) ? IsBelow(bound[p], *values[p], floats, slack)
                              : IsAbove(bound[p], *values[p], floats, slack);
      }
      if (!result) return result << ": plane " << p;
    }
    return ::testing::AssertionSuccess();
  }

  std::size_t dims;
  std::size_t minima;
  std::vector<std::optional<ExactValue>> values;
};

// The convex hull of what was added.
class ExactHull {
 public:
  explicit ExactHull(std::size_t dims) : planes_(dims, dims + 1, dims + 1) {}

  void AddPoint(const ExactPoint& point) { AddSphere(point, 0); }

  void AddSphere(const ExactPoint& center, const mpq_class& radius) {
    const std::size_t dims = planes_.dims;
    mpq_class d = 0;
    for (std::size_t k = 0; k < dims; ++k) {
      Add(k, mpq_class(center[k] - radius), mpq_class(center[k] + radius));
      d -= center[k];
    }
    const int root = static_cast<int>(dims);
    Add(dims, {d, -radius, root}, {d, radius, root});
  }

  // Of points.
  mpq_class LowestD() const { return planes_.values[planes_.dims]->rational; }

  ::testing::AssertionResult IsEnclosedBy(const float* bound,
                                          Looseness loose) const {
    return planes_.AreTightIn(bound, loose);
  }

 private:
  void Add(std::size_t axis, const ExactValue& low, const ExactValue& high) {
    auto& min = planes_.values[axis];
    auto& max = planes_.values[axis + planes_.minima];
    if (!min || Compare(low, *min) < 0) min = low;
    if (!max || Compare(high, *max) > 0) max = high;
  }

  ExactPlanes planes_;
};

// The numbers of a shape as exact ones.
class ExactNumbers {
 public:
  ExactNumbers(const Builder& builder, const Shape& shape)
      : dims_(builder.dims), builder_(builder), shape_(shape) {}

  mpq_class operator[](std::size_t i) const {
    return Exact(builder_.Number(shape_, i));
  }
  ExactPoint Point(std::size_t first) const {
    ExactPoint point;
    for (std::size_t k = 0; k < dims_; ++k) point.push_back((*this)[first + k]);
    return point;
  }
  // start + times * the direction at `first`.
  ExactPoint Along(ExactPoint start, const mpq_class& times,
                   std::size_t first) const {
    for (std::size_t k = 0; k < dims_; ++k) {
      start[k] += times * (*this)[first + k];
    }
    return start;
  }
  // By the map of an image.
  ExactPoint Image(const ExactPoint& point) const {
    const std::size_t map = builder_.first_argument();
    ExactPoint image = Point(map + dims_ * dims_);
    for (std::size_t i = 0; i < dims_; ++i) {
      for (std::size_t k = 0; k < dims_; ++k) {
        image[i] += (*this)[map + i * dims_ + k] * point[k];
      }
    }
    return image;
  }

 private:
  std::size_t dims_;
  const Builder& builder_;
  const Shape& shape_;
};

// Of all shapes but frusta; of one of the pieces of a segment.
inline ExactHull HullOf(const Builder& builder, const Shape& shape,
                        std::size_t piece = 0, std::size_t pieces = kPieces) {
  const std::size_t dims = builder.dims;
  const std::size_t corners = std::size_t{1} << dims;
  const ExactNumbers numbers(builder, shape);
  ExactHull hull(dims);
  switch (builder.kind) {
    case Kind::kPoints:
    case Kind::kSegment:
    case Kind::kTriangle:
      for (std::size_t i = 0; i < builder.roles.size(); i += dims) {
        hull.AddPoint(numbers.Point(i));
      }
      break;
    case Kind::kRay:
      hull.AddPoint(numbers.Point(0));
      hull.AddPoint(numbers.Along(numbers.Point(0), numbers[2 * dims], dims));
      break;
    case Kind::kPieces:
      for (std::size_t end : {piece, piece + 1}) {
        const mpq_class share = mpq_class(end) / mpq_class(pieces);
        ExactPoint point;
        for (std::size_t k = 0; k < dims; ++k) {
          point.push_back(numbers[k] +
                          share * (numbers[dims + k] - numbers[k]));
        }
        hull.AddPoint(point);
      }
      break;
    case Kind::kBox:
      // Two opposite corners have the extremes of D too.
      hull.AddPoint(numbers.Point(0));
      hull.AddPoint(numbers.Point(dims));
      break;
    case Kind::kOrientedBox:
      for (std::size_t corner = 0; corner < corners; ++corner) {
        ExactPoint point = numbers.Point(0);
        for (std::size_t i = 0; i < dims; ++i) {
          const mpq_class half = numbers[dims + dims * dims + i];
          point = numbers.Along(
              point, (corner >> i & 1) != 0 ? mpq_class(-half) : half,
              dims + i * dims);
        }
        hull.AddPoint(point);
      }
      break;
    case Kind::kSphere:
      hull.AddSphere(numbers.Point(0), numbers[dims]);
      break;
    case Kind::kCapsule:
      hull.AddSphere(numbers.Point(0), numbers[2 * dims]);
      hull.AddSphere(numbers.Point(dims), numbers[2 * dims]);
      break;
    case Kind::kImageOfPoints:
      for (std::size_t i = 0; i < kPointsOfSet; ++i) {
        hull.AddPoint(numbers.Image(numbers.Point(i * dims)));
      }
      break;
    case Kind::kImageOfBox:
      for (std::size_t corner = 0; corner < corners; ++corner) {
        ExactPoint point = numbers.Point(0);
        for (std::size_t k = 0; k < dims; ++k) {
          if ((corner >> k & 1) != 0) point[k] = numbers[dims + k];
        }
        hull.AddPoint(numbers.Image(point));
      }
      break;
    case Kind::kChange:
      break;
  }
  return hull;
}

// The results that a status has counted before a call.
inline constexpr std::size_t kCountedBefore = 10;

struct Outcome {
  bool is_refused = false;
  std::string message;  // of the error
  Planes planes{};
  FitStatus status;
};

Outcome Try(const Builder& builder, const Shape& shape,
            const FitStatus& before = {.results = kCountedBefore});

// The largest sum of the magnitudes that make up a point. It decides whether
// the shape can be bounded. The signs of the numbers do not matter.
mpq_class WeightOf(const Builder& builder, Shape shape);

// The outcome is an error, Empty(), Everything() or a bound, as it must be. A
// bound encloses the exact shape, and is as tight as the header says. All rows,
// but TranslateVertices() only with numbers that are not finite.
::testing::AssertionResult IsExact(const Builder& builder, const Shape& shape,
                                   const Outcome& outcome);
inline ::testing::AssertionResult IsExact(const Builder& builder,
                                          const Shape& shape) {
  return IsExact(builder, shape, Try(builder, shape));
}

// Of TranslateVertices(): makes the planes of `shape` a bound of the vertices,
// which are the numbers of a triangle.
void SetPlanesOfVertices(const Builder& builder, const Shape& vertices,
                         Shape& shape);

// Then the outcome encloses the vertices that are really moved, and rounded,
// and is tight.
::testing::AssertionResult EnclosesMovedVertices(const Builder& builder,
                                                 const Shape& vertices,
                                                 const Shape& shape,
                                                 const Outcome& outcome);

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_FIT_EXACT_ANSWERS_H_
