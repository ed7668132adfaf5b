// The bound of a frustum, from its planes. Its corners are among the points
// where three planes meet. The signs of exact determinants decide which points
// are corners, and whether the planes close a volume.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <new>
#include <optional>
#include <string>
#include <type_traits>

#include "dispatch/errors/error.h"
#include "dispatch/errors/memory_checks.h"
#include "dispatch/exact/exact_bound.h"
#include "dispatch/exact/outward.h"
#include "dispatch/exact/quotient.h"
#include "halfspace/fit.h"

namespace halfspace {
namespace {

using dispatch::ExactSum;
using dispatch::Negated;
using dispatch::SumExactly;

constexpr std::size_t kPlanes = 6;

template <typename Scalar>
using Planes = Span<const HalfSpace<3, Scalar>>;

// The number of doubles of a product of three: for floats a double and its
// error, for doubles twice as many.
template <typename Scalar>
constexpr std::size_t kProductTerms = std::is_same_v<Scalar, float> ? 2 : 4;
// Of a determinant: six products.
template <typename Scalar>
constexpr std::size_t kTerms = 6 * kProductTerms<Scalar>;
template <typename Scalar>
using Terms = std::array<double, kTerms<Scalar>>;

template <typename Scalar>
using Column = std::array<Scalar, 3>;

void WriteProduct(double a, double b, double* terms) {
  terms[0] = a * b;
  terms[1] = std::fma(a, b, -terms[0]);
}
void WriteProduct(float a, float b, float c, double* terms) {
  WriteProduct(double{a} * double{b}, double{c}, terms);
}
void WriteProduct(double a, double b, double c, double* terms) {
  const double pair = a * b;
  WriteProduct(pair, c, terms);
  WriteProduct(std::fma(a, b, -pair), c, terms + 2);
}

// The terms of the determinant with these columns.
template <typename Scalar>
Terms<Scalar> DeterminantTerms(const Column<Scalar>& a, const Column<Scalar>& b,
                               const Column<Scalar>& c) {
  constexpr std::array<std::array<std::size_t, 3>, 3> kCyclic = {
      {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}}};
  Terms<Scalar> terms;
  double* next = terms.data();
  for (const auto& [i, j, k] : kCyclic) {
    WriteProduct(a[i], b[j], c[k], next);
    next += kProductTerms<Scalar>;
    WriteProduct(-a[i], b[k], c[j], next);
    next += kProductTerms<Scalar>;
  }
  return terms;
}

// Three of the planes, as the columns of n . p = -offset.
template <typename Scalar>
struct Meeting {
  std::array<Column<Scalar>, 3> normals;  // column k: coordinate k of each
  Column<Scalar> right;

  Meeting(const HalfSpace<3, Scalar>& a, const HalfSpace<3, Scalar>& b,
          const HalfSpace<3, Scalar>& c)
      : right{-a.offset, -b.offset, -c.offset} {
    for (std::size_t k = 0; k < 3; ++k) {
      normals[k] = {a.normal[k], b.normal[k], c.normal[k]};
    }
  }

  Terms<Scalar> Denominator() const {
    return DeterminantTerms<Scalar>(normals[0], normals[1], normals[2]);
  }

  // Cramer's rule: coordinate k of the point is this over the denominator.
  Terms<Scalar> Numerator(std::size_t k) const {
    std::array<Column<Scalar>, 3> columns = normals;
    columns[k] = right;
    return DeterminantTerms<Scalar>(columns[0], columns[1], columns[2]);
  }
};

// A number with the sign of the sum.
template <std::size_t kCount>
double SignOf(const std::array<double, kCount>& terms) {
  double sum = 0.0;
  double magnitude = 0.0;
  for (double term : terms) {
    sum += term;
    magnitude += std::fabs(term);
  }
  if (std::fabs(sum) > magnitude * (kCount * 0x1p-52)) return sum;
  return SumExactly(terms).value;
}

// A number with the sign of the determinant of three normals.
template <typename Scalar>
double Determinant(Planes<Scalar> planes, std::size_t i, std::size_t j,
                   std::size_t k) {
  return SignOf(Meeting(planes[i], planes[j], planes[k]).Denominator());
}

// Whether the set is unbounded: some direction stays in front of all planes. If
// there is such a direction, there is one along which two planes meet, or all
// normals are in one plane.
template <typename Scalar>
bool IsOpen(Planes<Scalar> planes) {
  bool is_flat = true;
  for (std::size_t i = 0; i < kPlanes; ++i) {
    for (std::size_t j = i + 1; j < kPlanes; ++j) {
      bool some_rise = false;
      bool some_fall = false;
      for (std::size_t k = 0; k < kPlanes; ++k) {
        if (k == i || k == j) continue;
        const double slope = Determinant<Scalar>(planes, k, i, j);
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
template <typename Scalar>
struct Corner {
  std::array<Terms<Scalar>, 3> numerators;
  Terms<Scalar> denominator;
  double determinant;
  std::array<double, 3> point;  // good to kQuotientError
};

// A number with the sign of the height of the corner above the plane times the
// determinant.
template <typename Scalar>
double TimesDeterminant(const HalfSpace<3, Scalar>& plane,
                        const Corner<Scalar>& corner) {
  std::array<double, 2 * 4 * kTerms<Scalar>> terms;
  double* next = terms.data();
  const auto add = [&](Scalar factor, const Terms<Scalar>& parts) {
    for (double part : parts) {
      WriteProduct(double{factor}, part, next);
      next += 2;
    }
  };
  for (std::size_t k = 0; k < 3; ++k) {
    add(plane.normal[k], corner.numerators[k]);
  }
  add(plane.offset, corner.denominator);
  return SignOf(terms);
}

// Whether the corner is in front of the plane or on it.
template <typename Scalar>
bool IsInFront(const HalfSpace<3, Scalar>& plane,
               const Corner<Scalar>& corner) {
  double height = plane.offset;
  double magnitude = std::fabs(height);
  for (std::size_t k = 0; k < 3; ++k) {
    const double term = double{plane.normal[k]} * corner.point[k];
    height += term;
    magnitude += std::fabs(term);
  }
  // The sum is rounded a few times, too.
  if (std::fabs(height) > magnitude * 2.0 * dispatch::kQuotientError) {
    return height > 0.0;
  }
  const double exact = TimesDeterminant(plane, corner);
  return corner.determinant > 0.0 ? exact >= 0.0 : exact <= 0.0;
}

void AddQuotient(const ExactSum& numerator, const ExactSum& denominator,
                 std::size_t axis, Aabo3& bound) {
  bound.min[axis] =
      std::min(bound.min[axis], dispatch::QuotientDown(numerator, denominator));
  bound.max[axis] =
      std::max(bound.max[axis], dispatch::QuotientUp(numerator, denominator));
}

// Adds the point where the planes i, j and k meet, if it is a corner. False if
// it cannot be bounded.
template <typename Scalar>
bool AddCorner(Planes<Scalar> planes, std::size_t i, std::size_t j,
               std::size_t k, Aabo3& bound) {
  const Meeting meeting(planes[i], planes[j], planes[k]);
  Corner<Scalar> corner;
  corner.denominator = meeting.Denominator();
  const ExactSum determinant = SumExactly(corner.denominator);
  if (determinant.value == 0.0) return true;

  corner.determinant = determinant.value;
  std::array<double, 3 * kTerms<Scalar>> all;
  std::array<ExactSum, 3> numerators;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Terms<Scalar> terms = meeting.Numerator(axis);
    std::copy(terms.begin(), terms.end(), all.begin() + axis * kTerms<Scalar>);
    numerators[axis] = SumExactly(terms);
    corner.numerators[axis] = terms;
    corner.point[axis] = numerators[axis].value / determinant.value;
  }
  for (std::size_t other = 0; other < kPlanes; ++other) {
    if (other == i || other == j || other == k) continue;
    if (!IsInFront(planes[other], corner)) return true;
  }
  if (!dispatch::CanBeBounded(corner.point)) return false;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    AddQuotient(numerators[axis], determinant, axis, bound);
  }
  AddQuotient(Negated(SumExactly(all)), determinant, 3, bound);
  return true;
}

template <typename Scalar>
std::optional<Aabo3> TryFrustum(Planes<Scalar> planes) {
  if (IsOpen<Scalar>(planes)) return std::nullopt;
  Aabo3 bound = Aabo3::Empty();
  for (std::size_t i = 0; i < kPlanes; ++i) {
    for (std::size_t j = i + 1; j < kPlanes; ++j) {
      for (std::size_t k = j + 1; k < kPlanes; ++k) {
        if (!AddCorner<Scalar>(planes, i, j, k, bound)) return std::nullopt;
      }
    }
  }
  return bound;
}

template <typename Scalar>
bool AreFinite(Planes<Scalar> planes) {
  for (const auto& plane : planes) {
    const auto& n = plane.normal;
    for (Scalar value : {n[0], n[1], n[2], plane.offset}) {
      if (!std::isfinite(value)) return false;
    }
  }
  return true;
}

std::optional<Aabo3> TryAny(Planes<float> planes) {
  if (!AreFinite<float>(planes)) return std::nullopt;
  return TryFrustum<float>(planes);
}

// The same half-space with the largest number of its normal in [1, 2). The
// others must be so near to it that a double holds the error of a product of
// four. Returns nothing if they are not. If the normal is 0, only the sign of
// the offset counts.
std::optional<HalfSpace<3, double>> Scaled(const HalfSpace<3, double>& plane) {
  constexpr double kMost = 0x1p200;
  const auto& n = plane.normal;
  const double largest =
      std::max({std::fabs(n[0]), std::fabs(n[1]), std::fabs(n[2])});
  if (largest == 0.0) {
    const double offset = plane.offset == 0.0 ? 0.0 : 1.0;
    return HalfSpace<3, double>{{}, std::copysign(offset, plane.offset)};
  }
  const int exponent = -std::ilogb(largest);
  bool ok = true;
  const auto scaled = [&](double value) {
    const double result = std::scalbn(value, exponent);
    const double magnitude = std::fabs(result);
    ok &= value == 0.0 || (magnitude >= 1.0 / kMost && magnitude <= kMost);
    return result;
  };
  const HalfSpace<3, double> result = {
      {scaled(n[0]), scaled(n[1]), scaled(n[2])}, scaled(plane.offset)};
  if (!ok) return std::nullopt;
  return result;
}

std::optional<Aabo3> TryAny(Planes<double> planes) {
  if (!AreFinite<double>(planes)) return std::nullopt;
  std::array<HalfSpace<3, double>, kPlanes> all;
  for (std::size_t i = 0; i < kPlanes; ++i) {
    const auto scaled = Scaled(planes[i]);
    if (!scaled) return std::nullopt;
    all[i] = *scaled;
  }
  return TryFrustum<double>(all);
}

template <typename Scalar>
void BoundPlanes(const detail::AnyShape& any, std::size_t count,
                 FitStatus* status) {
  const Planes<Scalar> planes(
      static_cast<const HalfSpace<3, Scalar>*>(any.shape), count);
  if (planes.size() != kPlanes) {
    dispatch::ThrowInvalid("BoundFrustum", "planes", "6 planes",
                           std::to_string(planes.size()));
  }
  dispatch::CheckPointer(
      "BoundFrustum", planes.data(), alignof(HalfSpace<3, Scalar>),
      [] { return "planes"; }, [] { return "6 planes"; });
  new (any.bound)
      Aabo3(dispatch::Build(status, [&] { return TryAny(planes); }));
}

}  // namespace

void detail::BoundFrustum(const AnyShape& planes, std::size_t count,
                          FitStatus* status) {
  planes.is_double ? BoundPlanes<double>(planes, count, status)
                   : BoundPlanes<float>(planes, count, status);
}

}  // namespace halfspace
