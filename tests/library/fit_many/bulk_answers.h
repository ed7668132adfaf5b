// Random shapes for the rows of bulk.h, and what a call for many shapes must
// give for each of them.
#ifndef HALFSPACE_TESTS_LIBRARY_FIT_MANY_BULK_ANSWERS_H_
#define HALFSPACE_TESTS_LIBRARY_FIT_MANY_BULK_ANSWERS_H_

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "tests/library/fit/exact_answers.h"
#include "tests/library/fit/random_shapes.h"
#include "tests/library/fit_many/bulk.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/fp_modes.h"

namespace halfspace::testing {

inline BulkShapes RandomShapes(const Bulk& bulk, PointKind kind,
                               std::size_t count, Random& random) {
  const RandomNumbers numbers(kind, bulk.is_double, random);
  BulkShapes shapes(count);
  for (auto& shape : shapes) {
    if (bulk.kind == Kind::kPoints) {
      // Few points, or, now and then, more than fill some vectors.
      std::size_t points = 1 + random() % 4;
      if (OneIn(16, random)) points += random() % 150;
      shape.resize(points * bulk.dims);
      for (std::size_t i = 0; i < shape.size(); i += bulk.dims) {
        numbers.FillPoint(std::span(shape).subspan(i, bulk.dims));
      }
      continue;
    }
    const Shape random_shape = RandomShape(bulk.single(), kind, random);
    for (std::size_t i = 0; i < bulk.single().roles.size(); ++i) {
      shape.push_back(bulk.single().Number(random_shape, i));
    }
  }
  return shapes;
}

// Some numbers become anything at all (Spoil()), unless rounding then decides
// if the shape can be bounded, and so the order of the sum.
inline void SpoilOne(const Bulk& bulk, std::vector<double>& numbers,
                     Random& random) {
  const Builder& single = bulk.single();
  const std::size_t count = single.roles.size();
  if (numbers.size() < count) return;
  Shape shape;
  for (std::size_t n = 0; n < count; ++n) shape.Set(n, numbers[n]);
  Spoil(single, shape, random);
  const std::size_t in_point = bulk.dims + (bulk.kind == Kind::kSphere ? 1 : 0);
  for (std::size_t i = 0; i < count; i += in_point) {
    double sum = 0;
    for (std::size_t n = i; n < i + in_point; ++n) {
      sum += std::fabs(single.Number(shape, n));
    }
    if (std::fabs(sum - 0x1p125) <= 0x1p105) return;
  }
  for (std::size_t n = 0; n < count; ++n) numbers[n] = single.Number(shape, n);
}

class BulkAnswers {
 public:
  BulkAnswers(const Bulk& bulk, BulkShapes shapes,
              const FitOptions& options = {})
      : bulk_(bulk), shapes_(std::move(shapes)), options_(options) {
    for (const auto& shape : shapes_) expected_.push_back(Single(shape));
  }

  // For a mistake that the numbers of the shape do not show.
  void Set(std::size_t i, const Planes& bound) { expected_[i] = bound; }

  // Makes the call on every target, for a source that was placed in the arena
  // and may have fewer shapes. The first bound of each shape is compared with
  // that of the builder of one, and the others, of this call and of later ones,
  // with the first. `wanted` has a bit for each plane.
  ::testing::AssertionResult Check(const BulkSource& source, Arena& arena,
                                   std::uint32_t wanted = 0xFFFFFFFF,
                                   FpMode mode = FpMode::kDefault) {
    const BulkOutput built(bulk_, source.size, arena);
    detail::Output output;
    output.size = source.size;
    std::vector<std::size_t> planes;
    for (std::size_t p = 0; p < bulk_.planes(); ++p) {
      if ((wanted >> p & 1) == 0) continue;
      planes.push_back(p);
      output.Want(p, built.output().planes[p]);
    }
    const Planes everything = bulk_.single().Everything();
    FitStatus expected{.results = kCountedBefore + source.size};
    for (std::size_t i = 0; i < source.size; ++i) {
      if (expected_[i] == everything && expected.everything++ == 0) {
        expected.first_everything = kCountedBefore + i;
      }
    }
    for (Target target : TargetsUnderTest()) {
      const auto wrong = [&] {
        return ::testing::AssertionFailure()
               << "on " << target.name() << ", " << source.size << " shapes, "
               << "planes " << wanted << ": ";
      };
      FitOptions options = options_;
      options.target = target;
      FitStatus status{.results = kCountedBefore};
      Target ran;
      RunIn(mode, [&] { ran = source.Bound(output, options, &status); });
      if (ran != target) return wrong() << "ran on " << ran.name();
      if (!arena.Intact()) return wrong() << "wrote elsewhere";
      if (status.results != expected.results ||
          status.everything != expected.everything ||
          status.first_everything != expected.first_everything) {
        return wrong() << "a wrong status";
      }
      for (std::size_t i = 0; i < source.size; ++i) {
        Planes bound = i < first_.size() ? first_[i] : expected_[i];
        for (std::size_t p : planes) bound[p] = output.planes[p][i];
        if (i == first_.size()) {
          first_.push_back(bound);
          // Exact arithmetic once for shapes that are all the same.
          const bool is_again = i > 0 && shapes_[i] == shapes_[i - 1] &&
                                expected_[i] == expected_[i - 1] &&
                                SameBits(bound, first_[i - 1]);
          auto result =
              is_again ? ::testing::AssertionSuccess() : IsBoundOfOne(i);
          if (!result) return wrong() << result.message() << ", shape " << i;
        }
        if (!SameBits(bound, first_[i])) {
          return wrong() << "shape " << i << " has another bound";
        }
      }
    }
    return ::testing::AssertionSuccess();
  }

 private:
  // An inverted box is a mistake, or empty.
  Planes Single(const std::vector<double>& numbers) const {
    bool is_inverted = false;
    bool has_nan = false;
    for (std::size_t k = 0; bulk_.kind == Kind::kBox && k < bulk_.dims; ++k) {
      is_inverted |= numbers[k] > numbers[bulk_.dims + k];
      has_nan |= std::isnan(numbers[k]) || std::isnan(numbers[bulk_.dims + k]);
    }
    return is_inverted && !has_nan && options_.inverted == Inverted::kEmpty
               ? bulk_.single().Empty()
               : bulk_.Single(numbers);
  }

  // A bound of doubles has the bits of the single builder's. A bound of floats
  // has its special values, and X, Y and Z of points. Its other values enclose
  // the shape.
  ::testing::AssertionResult IsBoundOfOne(std::size_t i) const {
    const Planes& bound = first_[i];
    const Planes& single = expected_[i];
    const std::vector<double>& numbers = shapes_[i];
    const std::size_t d = bulk_.dims;
    const bool is_sphere = bulk_.kind == Kind::kSphere;
    const bool is_same = bulk_.is_double ||
                         single == bulk_.single().Everything() ||
                         single == bulk_.single().Empty();
    for (std::size_t p = 0; p < bulk_.planes(); ++p) {
      const bool may_differ = !is_same && (is_sphere || p % (d + 1) == d);
      if (bound[p] != single[p] && !may_differ) {
        return ::testing::AssertionFailure()
               << "plane " << p << " is " << bound[p] << ", and of one shape "
               << single[p];
      }
    }
    if (is_same) return ::testing::AssertionSuccess();
    ExactHull hull(d);
    double weight = 0;
    const mpq_class radius = is_sphere ? Exact(numbers[d]) : mpq_class(0);
    for (std::size_t n = 0; n + d <= numbers.size(); n += d) {
      ExactPoint point;
      double of_point = is_sphere ? 2 * numbers[d] : 0;
      for (std::size_t k = 0; k < d; ++k) {
        point.push_back(Exact(numbers[n + k]));
        of_point += std::fabs(numbers[n + k]);
      }
      hull.AddSphere(point, radius);
      weight = std::max(weight, of_point);
    }
    return hull.IsEnclosedBy(bound.data(),
                             {.floats = 1, .slack = 0x1p-40 * weight});
  }

  Bulk bulk_;
  BulkShapes shapes_;
  FitOptions options_;
  std::vector<Planes> expected_;
  std::vector<Planes> first_;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_FIT_MANY_BULK_ANSWERS_H_
