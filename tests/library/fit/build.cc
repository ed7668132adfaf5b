// The calls of the rows of builders.h. This file is compiled twice: as any
// caller's, and with -ffast-math (fast_math_caller_test.cc).
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>

#include "halfspace/detail/plane_arrays.h"
#include "halfspace/fit.h"
#include "tests/library/fit/builders.h"

#if !defined(HALFSPACE_COMPILED_AS)
#define HALFSPACE_COMPILED_AS usual
#endif

namespace halfspace::testing {
namespace {

template <typename T>
const T* NumbersOf(const Shape& shape) {
  if constexpr (std::is_same_v<T, float>) {
    return shape.floats.data();
  } else {
    return shape.doubles.data();
  }
}

template <typename To, typename T>
To As(const T* numbers) {
  static_assert(sizeof(To) % sizeof(T) == 0);
  To to;
  std::memcpy(&to, numbers, sizeof(to));
  return to;
}

template <typename Use>
void WithDims(std::size_t dims, Use use) {
  if (dims == 2) use(DimsConstant<2>());
  if (dims == 3) use(DimsConstant<3>());
  if (dims == 4) use(DimsConstant<4>());
}

// Calls use(points), or use(points, indices).
template <int kDims, typename T, typename Use>
void WithPoints(PointLayout layout, const T* numbers, Use use) {
  constexpr std::size_t kStride = kDims + 2;
  constexpr std::array<std::uint32_t, 4> kIndices = {5, 1, 3, 1};
  if (layout == PointLayout::kPacked) {
    use(Points<kDims, T>{numbers, kPointsOfSet});
    return;
  }
  const bool is_soa =
      layout == PointLayout::kSoa || layout == PointLayout::kIndexedSoa;
  const bool is_indexed = layout >= PointLayout::kIndexed;
  const std::size_t count = (is_indexed ? 2 : 1) * kPointsOfSet;
  const std::size_t first = layout == PointLayout::kStrided ? kPointsOfSet : 0;
  // The gap after the last point of a stride need not exist.
  std::array<T, 2 * kPointsOfSet * kStride - (kStride - kDims)> room;
  room.fill(std::numeric_limits<T>::quiet_NaN());
  for (std::size_t i = 0; i < kPointsOfSet; ++i) {
    const std::size_t place = is_indexed ? 2 * i + 1 : first + i;
    for (std::size_t k = 0; k < kDims; ++k) {
      room[is_soa ? k * count + place : place * kStride + k] =
          numbers[i * kDims + k];
    }
  }
  const Points<kDims, T> points{&room[first * kStride], count, kStride};
  PointsSoa<kDims, T> soa{.coords = {}, .count = count};
  for (std::size_t k = 0; k < kDims; ++k) soa.coords[k] = &room[k * count];
  if (layout == PointLayout::kStrided) use(points);
  if (layout == PointLayout::kSoa) use(soa);
  if (layout == PointLayout::kIndexed) use(points, kIndices);
  if (layout == PointLayout::kIndexedSoa) use(soa, kIndices);
}

template <int kDims, typename T>
void BuildShape(const Builder& builder, const Shape& shape,
                std::array<Aabo<kDims>, kPieces>& bounds, FitStatus* status) {
  const T* const numbers = NumbersOf<T>(shape);
  const std::size_t map = builder.first_argument();
  Aabo<kDims>& bound = bounds[0];
  const auto transformed = [&](const auto& of) {
    bound =
        builder.is_map_double
            ? BoundTransformed(
                  of, As<Affine<kDims, double>>(&shape.doubles[map]), status)
            : BoundTransformed(of, As<Affine<kDims>>(&shape.floats[map]),
                               status);
  };
  switch (builder.kind) {
    case Kind::kPoints:
      return WithPoints<kDims>(builder.layout, numbers,
                               [&](const auto& points, const auto&... indices) {
                                 bound = BoundPoints<kDims, T>(
                                     points, indices..., status);
                               });
    case Kind::kSegment:
      bound = BoundSegment(As<Segment<kDims, T>>(numbers), status);
      return;
    case Kind::kTriangle:
      bound = BoundTriangle(As<Triangle<kDims, T>>(numbers), status);
      return;
    case Kind::kRay:
      bound = BoundRay(As<Ray<kDims, T>>(numbers), status);
      return;
    case Kind::kPieces:
      return BoundSegmentPieces(As<Segment<kDims, T>>(numbers), bounds, status);
    case Kind::kBox:
      bound = BoundAabb(As<Box<kDims, T>>(numbers), status);
      return;
    case Kind::kOrientedBox:
      bound = BoundOrientedBox(As<OrientedBox<kDims, T>>(numbers), status);
      return;
    case Kind::kSphere:
      bound = BoundSphere(As<Sphere<kDims, T>>(numbers), status);
      return;
    case Kind::kCapsule:
      bound = BoundCapsule(As<Capsule<kDims, T>>(numbers), status);
      return;
    case Kind::kImageOfPoints:
      return transformed(Points<kDims, T>{numbers, kPointsOfSet});
    case Kind::kImageOfBox:
      return transformed(As<Box<kDims, T>>(numbers));
    case Kind::kChange:
      return;
  }
}

template <typename Bound>
void ChangeBound(const Builder& builder, const float* numbers, Planes& planes,
                 FitStatus* status) {
  const auto give = [&](const auto& result) {
    std::memcpy(planes.data(), &result, sizeof(result));
  };
  const auto bound = As<Bound>(numbers);
  const float* const argument = numbers + builder.first_argument();
  const auto move = As<Point<Bound::kDimensions>>(argument);
  switch (builder.change) {
    case Change::kMerge:
      return give(Merge(bound, As<Bound>(argument), status));
    case Change::kInflate:
      return give(Inflate(bound, *argument, status));
    case Change::kInflateByBox:
      return give(InflateByBox(bound, *argument, status));
    case Change::kTranslate:
      return give(Translate(bound, move, status));
    case Change::kTranslateVertices:
      if constexpr (detail::HasMin<Bound> && detail::HasMax<Bound>) {
        give(TranslateVertices(bound, move, status));
      }
      return;
    case Change::kScale:
      return give(Scale(bound, *argument, status));
    case Change::kSweep:
      return give(Sweep(bound, move, status));
  }
}

}  // namespace

namespace HALFSPACE_COMPILED_AS {

Planes Build(const Builder& builder, const Shape& shape, FitStatus* status) {
  Planes planes{};
  WithDims(builder.dims, [&](auto its_dims) {
    constexpr int kDims = decltype(its_dims)::value;
    if (builder.kind != Kind::kChange) {
      std::array<Aabo<kDims>, kPieces> bounds;
      if (builder.is_double) {
        BuildShape<kDims, double>(builder, shape, bounds, status);
      } else {
        BuildShape<kDims, float>(builder, shape, bounds, status);
      }
      std::memcpy(planes.data(), bounds.data(),
                  builder.results() * sizeof(bounds[0]));
      return;
    }
    const float* const numbers = shape.floats.data();
    switch (builder.part) {
      case Part::kAabo:
        return ChangeBound<Aabo<kDims>>(builder, numbers, planes, status);
      case Part::kAabb:
        return ChangeBound<Aabb<kDims>>(builder, numbers, planes, status);
      case Part::kUp:
        return ChangeBound<UpSimplex<kDims>>(builder, numbers, planes, status);
      case Part::kDown:
        return ChangeBound<DownSimplex<kDims>>(builder, numbers, planes,
                                               status);
    }
  });
  return planes;
}

}  // namespace HALFSPACE_COMPILED_AS
}  // namespace halfspace::testing
