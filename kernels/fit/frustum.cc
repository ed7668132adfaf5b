// A frustum, from its planes: its corners are where three planes meet, and
// determinants of floats, exact as sums, tell which of those are corners and
// whether the planes close a volume at all.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>

#include "halfspace/fit.h"
#include "kernels/exact/default_fp_mode.h"
#include "kernels/exact/exact_bound.h"
#include "kernels/exact/outward.h"
#include "kernels/exact/quotient.h"
#include "kernels/memory_checks.h"

namespace halfspace {
namespace {

using kernels::ExactSum;
using kernels::Finish;
using kernels::Negated;
using kernels::SumExactly;

constexpr std::size_t kPlanes = 6;
constexpr std::size_t kTerms = 12;  // of a determinant: six products, two each

using Planes = Span<const HalfSpace3>;
using Terms = std::array<double, kTerms>;
using Column = std::array<float, 3>;

// The terms of the determinant with these columns. Each product of three floats
// is a double and its rounding error.
Terms DeterminantTerms(const Column& a, const Column& b, const Column& c) {
  constexpr std::array<std::array<std::size_t, 3>, 3> kCyclic = {
      {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}}};
  Terms terms;
  std::size_t n = 0;
  for (const auto& [i, j, k] : kCyclic) {
    for (double sign : {1.0, -1.0}) {
      const float second = sign > 0.0 ? b[j] : b[k];
      const float third = sign > 0.0 ? c[k] : c[j];
      const double pair = sign * double{a[i]} * double{second};  // exact
      const double product = pair * double{third};
      terms[n++] = product;
      terms[n++] = std::fma(pair, double{third}, -product);
    }
  }
  return terms;
}

// Three of the planes, as the columns of n . p = -offset.
struct Meeting {
  std::array<Column, 3> normals;  // column k: coordinate k of each normal
  Column right;

  Meeting(const HalfSpace3& a, const HalfSpace3& b, const HalfSpace3& c)
      : right{-a.offset, -b.offset, -c.offset} {
    for (std::size_t k = 0; k < 3; ++k) {
      normals[k] = {a.normal[k], b.normal[k], c.normal[k]};
    }
  }

  Terms Denominator() const {
    return DeterminantTerms(normals[0], normals[1], normals[2]);
  }

  // Cramer's rule: coordinate k of the point is this over the denominator.
  Terms Numerator(std::size_t k) const {
    std::array<Column, 3> columns = normals;
    columns[k] = right;
    return DeterminantTerms(columns[0], columns[1], columns[2]);
  }
};

double Determinant(Planes planes, std::size_t i, std::size_t j, std::size_t k) {
  return SumExactly(Meeting(planes[i], planes[j], planes[k]).Denominator())
      .value;
}

// Whether some direction never leaves the planes' front sides. If any does, one
// along which two planes meet does, or the normals lie in one plane.
bool IsOpen(Planes planes) {
  bool is_flat = true;
  for (std::size_t i = 0; i < kPlanes; ++i) {
    for (std::size_t j = i + 1; j < kPlanes; ++j) {
      bool some_rise = false;
      bool some_fall = false;
      for (std::size_t k = 0; k < kPlanes; ++k) {
        if (k == i || k == j) continue;
        const double slope = Determinant(planes, k, i, j);
        some_rise |= slope > 0.0;
        some_fall |= slope < 0.0;
      }
      if (some_rise != some_fall) return true;
      is_flat &= !some_rise;
    }
  }
  return is_flat;
}

// Where three planes meet.
struct Corner {
  std::array<Terms, 3> numerators;
  Terms denominator;
  double determinant;
  std::array<double, 3> point;  // good to kQuotientError
};

// The height of the corner above the plane times the determinant, exactly.
double TimesDeterminant(const HalfSpace3& plane, const Corner& corner) {
  std::array<double, 2 * 4 * kTerms> terms;
  std::size_t n = 0;
  const auto add = [&](float factor, const Terms& parts) {
    for (double part : parts) {
      const double product = double{factor} * part;
      terms[n++] = product;
      terms[n++] = std::fma(double{factor}, part, -product);
    }
  };
  for (std::size_t k = 0; k < 3; ++k) {
    add(plane.normal[k], corner.numerators[k]);
  }
  add(plane.offset, corner.denominator);
  return SumExactly(terms).value;
}

// Whether the corner is in front of the plane or on it.
bool IsInFront(const HalfSpace3& plane, const Corner& corner) {
  double height = plane.offset;
  double magnitude = std::fabs(height);
  for (std::size_t k = 0; k < 3; ++k) {
    const double term = double{plane.normal[k]} * corner.point[k];
    height += term;
    magnitude += std::fabs(term);
  }
  // The sum rounds a few times, too.
  if (std::fabs(height) > magnitude * 2.0 * kernels::kQuotientError) {
    return height > 0.0;
  }
  const double exact = TimesDeterminant(plane, corner);
  return corner.determinant > 0.0 ? exact >= 0.0 : exact <= 0.0;
}

void AddQuotient(const ExactSum& numerator, const ExactSum& denominator,
                 std::size_t axis, Aabo3& bound) {
  bound.min[axis] =
      std::min(bound.min[axis], kernels::QuotientDown(numerator, denominator));
  bound.max[axis] =
      std::max(bound.max[axis], kernels::QuotientUp(numerator, denominator));
}

// Adds the point where the planes i, j and k meet, if it is a corner. False if
// it cannot be bounded.
bool AddCorner(Planes planes, std::size_t i, std::size_t j, std::size_t k,
               Aabo3& bound) {
  const Meeting meeting(planes[i], planes[j], planes[k]);
  Corner corner;
  corner.denominator = meeting.Denominator();
  const ExactSum determinant = SumExactly(corner.denominator);
  if (determinant.value == 0.0) return true;

  corner.determinant = determinant.value;
  std::array<double, 3 * kTerms> all;
  std::array<ExactSum, 3> numerators;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Terms terms = meeting.Numerator(axis);
    std::copy(terms.begin(), terms.end(), all.begin() + axis * kTerms);
    numerators[axis] = SumExactly(terms);
    corner.numerators[axis] = terms;
    corner.point[axis] = numerators[axis].value / determinant.value;
  }
  for (std::size_t other = 0; other < kPlanes; ++other) {
    if (other == i || other == j || other == k) continue;
    if (!IsInFront(planes[other], corner)) return true;
  }
  if (!kernels::CanBeBounded(corner.point)) return false;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    AddQuotient(numerators[axis], determinant, axis, bound);
  }
  AddQuotient(Negated(SumExactly(all)), determinant, 3, bound);
  return true;
}

std::optional<Aabo3> TryFrustum(Planes planes) {
  for (const HalfSpace3& plane : planes) {
    const auto& n = plane.normal;
    for (float value : {n[0], n[1], n[2], plane.offset}) {
      if (!std::isfinite(value)) return std::nullopt;
    }
  }
  if (IsOpen(planes)) return std::nullopt;
  Aabo3 bound = Aabo3::Empty();
  for (std::size_t i = 0; i < kPlanes; ++i) {
    for (std::size_t j = i + 1; j < kPlanes; ++j) {
      for (std::size_t k = j + 1; k < kPlanes; ++k) {
        if (!AddCorner(planes, i, j, k, bound)) return std::nullopt;
      }
    }
  }
  return bound;
}

}  // namespace

Aabo3 BoundFrustum(Planes planes, FitStatus* status) {
  if (planes.size() != kPlanes) {
    kernels::ThrowInvalid("BoundFrustum", "planes", "6 planes",
                          std::to_string(planes.size()));
  }
  kernels::CheckPointer(
      "BoundFrustum", planes.data(), alignof(HalfSpace3),
      [] { return "planes"; }, [] { return "6 planes"; });
  return kernels::InDefaultFpMode(
      [&] { return Finish(TryFrustum(planes), status); });
}

}  // namespace halfspace
