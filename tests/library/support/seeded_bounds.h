// A bound by every builder, of shapes made of seeded numbers.
//
// In braces the order of evaluation is that of the text, so that every compiler
// draws the numbers in the same order; between parentheses it is not.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_SEEDED_BOUNDS_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_SEEDED_BOUNDS_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "halfspace/fit.h"
#include "tests/library/support/seeded_numbers.h"

namespace halfspace::testing {

// The builders, one function each. In alphabetical order of the calls.
template <int kDims>
struct SeededBounds {
  static constexpr auto kCoords = static_cast<std::size_t>(kDims);
  using Numbers = SeededNumbers;
  using Bound = Aabo<kDims>;

  static Bound OfAabb(Numbers& numbers) { return BoundAabb(Box(numbers)); }

  static Bound OfAabbInDouble(Numbers& numbers) {
    halfspace::Box<kDims, double> box = {numbers.DoubleCoordinates<kCoords>(),
                                         numbers.DoubleCoordinates<kCoords>()};
    Order(box.min, box.max);
    return BoundAabb(box);
  }

  static Bound OfCapsule(Numbers& numbers) {
    return BoundCapsule(Capsule<kDims>{Coordinates(numbers),
                                       Coordinates(numbers), numbers.Length()});
  }

  static Bound OfCapsuleInDouble(Numbers& numbers) {
    return BoundCapsule(Capsule<kDims, double>{
        numbers.DoubleCoordinates<kCoords>(),
        numbers.DoubleCoordinates<kCoords>(), double{numbers.Length()}});
  }

  static Bound OfOrientedBoxInDouble(Numbers& numbers) {
    OrientedBox<kDims, double> box;
    box.center = numbers.DoubleCoordinates<kCoords>();
    for (auto& axis : box.axes) axis = numbers.DoubleCoordinates<kCoords>();
    for (double& extent : box.half_extents) extent = numbers.Length();
    return BoundOrientedBox(box);
  }

  static Bound OfRayInDouble(Numbers& numbers) {
    return BoundRay(Ray<kDims, double>{numbers.DoubleCoordinates<kCoords>(),
                                       numbers.DoubleCoordinates<kCoords>(),
                                       double{numbers.Length()}});
  }

  static Bound OfSegmentPiecesInDouble(Numbers& numbers) {
    const Segment<kDims, double> segment = {
        numbers.DoubleCoordinates<kCoords>(),
        numbers.DoubleCoordinates<kCoords>()};
    std::array<Bound, 7> pieces;
    BoundSegmentPieces(segment, pieces);
    return pieces[numbers.Below(7)];
  }

  static Bound OfTransformedBoxInDouble(Numbers& numbers) {
    halfspace::Box<kDims, double> box = {numbers.DoubleCoordinates<kCoords>(),
                                         numbers.DoubleCoordinates<kCoords>()};
    Order(box.min, box.max);
    Affine<kDims, double> map;
    for (auto& row : map.linear) row = numbers.DoubleCoordinates<kCoords>();
    map.translation = numbers.DoubleCoordinates<kCoords>();
    return BoundTransformed(box, map);
  }

  static Bound OfOrientedBox(Numbers& numbers) {
    OrientedBox<kDims> box;
    box.center = Coordinates(numbers);
    for (auto& axis : box.axes) axis = Coordinates(numbers);
    for (float& extent : box.half_extents) extent = numbers.Length();
    return BoundOrientedBox(box);
  }

  static Bound OfPoints(Numbers& numbers) {
    const std::vector<float> coords = PointCoords(numbers);
    return BoundPoints(PointsIn(coords));
  }

  static Bound OfPointsInDouble(Numbers& numbers) {
    const auto coords = numbers.DoubleCoordinates<3 * kCoords>();
    return BoundPoints(Points<kDims, double>{coords.data(), 3});
  }

  static Bound OfIndexedPoints(Numbers& numbers) {
    const std::vector<float> coords = PointCoords(numbers);
    const Points<kDims> points = PointsIn(coords);
    std::vector<std::uint32_t> indices(3);
    for (std::uint32_t& index : indices) {
      index = numbers.Below(static_cast<std::uint32_t>(points.count));
    }
    return BoundPoints(points, indices);
  }

  static Bound OfRay(Numbers& numbers) {
    return BoundRay(Ray<kDims>{Coordinates(numbers), Coordinates(numbers),
                               numbers.Length()});
  }

  static Bound OfSegment(Numbers& numbers) {
    return BoundSegment(
        Segment<kDims>{Coordinates(numbers), Coordinates(numbers)});
  }

  static Bound OfSegmentPieces(Numbers& numbers) {
    const Segment<kDims> segment = {Coordinates(numbers), Coordinates(numbers)};
    std::array<Bound, 7> pieces;
    BoundSegmentPieces<kDims>(segment, pieces);
    return pieces[numbers.Below(7)];
  }

  static Bound OfSphere(Numbers& numbers) {
    return BoundSphere(Sphere<kDims>{Coordinates(numbers), numbers.Length()});
  }

  static Bound OfSphereInDouble(Numbers& numbers) {
    return BoundSphere(Sphere<kDims, double>{
        numbers.DoubleCoordinates<kCoords>(), double{numbers.Length()}});
  }

  static Bound OfTransformedBox(Numbers& numbers) {
    const Aabb<kDims> box = Box(numbers);
    return BoundTransformed(box, Map(numbers));
  }

  static Bound OfTransformedPoints(Numbers& numbers) {
    const std::vector<float> coords = PointCoords(numbers);
    return BoundTransformed(PointsIn(coords), Map(numbers));
  }

  static Bound OfTriangle(Numbers& numbers) {
    return BoundTriangle(Triangle<kDims>{
        Coordinates(numbers), Coordinates(numbers), Coordinates(numbers)});
  }

  // Both simplices of the result, so that both overloads count.
  static Bound Circumscribed(Numbers& numbers) {
    const Bound bound = OfPoints(numbers);
    return {Circumscribe(bound.down()).min, Circumscribe(bound.up()).max};
  }

  static Bound Inflated(Numbers& numbers) {
    const Bound bound = OfPoints(numbers);
    return Inflate(bound, numbers.Length());
  }

  static Bound InflatedByBox(Numbers& numbers) {
    const Bound bound = OfPoints(numbers);
    return InflateByBox(bound, numbers.Length());
  }

  static Bound Merged(Numbers& numbers) {
    const Bound bound = OfPoints(numbers);
    return Merge(bound, OfAabb(numbers));
  }

  static Bound Scaled(Numbers& numbers) {
    const Bound bound = OfPoints(numbers);
    return Scale(bound, numbers.WithExponent(-4, 3));
  }

  static Bound Swept(Numbers& numbers) {
    const Bound bound = OfPoints(numbers);
    return Sweep(bound, Coordinates(numbers));
  }

  static Bound Translated(Numbers& numbers) {
    const Bound bound = OfPoints(numbers);
    return Translate(bound, Coordinates(numbers));
  }

  static Bound WithTranslatedVertices(Numbers& numbers) {
    const Bound bound = OfPoints(numbers);
    return TranslateVertices(bound, Coordinates(numbers));
  }

 private:
  static Point<kDims> Coordinates(Numbers& numbers) {
    return numbers.Coordinates<kCoords>();
  }

  template <typename Corner>
  static void Order(Corner& min, Corner& max) {
    for (std::size_t k = 0; k < kCoords; ++k) {
      if (min[k] > max[k]) std::swap(min[k], max[k]);
    }
  }

  static Aabb<kDims> Box(Numbers& numbers) {
    Aabb<kDims> box = {Coordinates(numbers), Coordinates(numbers)};
    Order(box.min, box.max);
    return box;
  }

  // Of one to four points.
  static std::vector<float> PointCoords(Numbers& numbers) {
    std::vector<float> coords(kCoords * (1 + numbers.Below(4)));
    for (float& coord : coords) coord = numbers.Coordinate();
    return coords;
  }

  static Points<kDims> PointsIn(const std::vector<float>& coords) {
    return {coords.data(), coords.size() / kCoords};
  }

  static Affine<kDims> Map(Numbers& numbers) {
    Affine<kDims> map;
    for (auto& row : map.linear) row = Coordinates(numbers);
    map.translation = Coordinates(numbers);
    return map;
  }
};

template <int kDims>
struct SeededBuilder {
  const char* name;
  Aabo<kDims> (*build)(SeededNumbers& numbers);
};

template <int kDims>
inline constexpr std::array kSeededBuilders = {
    SeededBuilder<kDims>{"BoundAabb", &SeededBounds<kDims>::OfAabb},
    SeededBuilder<kDims>{"BoundAabb of doubles",
                         &SeededBounds<kDims>::OfAabbInDouble},
    SeededBuilder<kDims>{"BoundCapsule", &SeededBounds<kDims>::OfCapsule},
    SeededBuilder<kDims>{"BoundOrientedBox",
                         &SeededBounds<kDims>::OfOrientedBox},
    SeededBuilder<kDims>{"BoundPoints", &SeededBounds<kDims>::OfPoints},
    SeededBuilder<kDims>{"BoundPoints of doubles",
                         &SeededBounds<kDims>::OfPointsInDouble},
    SeededBuilder<kDims>{"BoundPoints by indices",
                         &SeededBounds<kDims>::OfIndexedPoints},
    SeededBuilder<kDims>{"BoundRay", &SeededBounds<kDims>::OfRay},
    SeededBuilder<kDims>{"BoundSegment", &SeededBounds<kDims>::OfSegment},
    SeededBuilder<kDims>{"BoundSegmentPieces",
                         &SeededBounds<kDims>::OfSegmentPieces},
    SeededBuilder<kDims>{"BoundSphere", &SeededBounds<kDims>::OfSphere},
    SeededBuilder<kDims>{"BoundSphere of doubles",
                         &SeededBounds<kDims>::OfSphereInDouble},
    SeededBuilder<kDims>{"BoundTransformed box",
                         &SeededBounds<kDims>::OfTransformedBox},
    SeededBuilder<kDims>{"BoundTransformed points",
                         &SeededBounds<kDims>::OfTransformedPoints},
    SeededBuilder<kDims>{"BoundTriangle", &SeededBounds<kDims>::OfTriangle},
    SeededBuilder<kDims>{"Circumscribe", &SeededBounds<kDims>::Circumscribed},
    SeededBuilder<kDims>{"Inflate", &SeededBounds<kDims>::Inflated},
    SeededBuilder<kDims>{"InflateByBox", &SeededBounds<kDims>::InflatedByBox},
    SeededBuilder<kDims>{"Merge", &SeededBounds<kDims>::Merged},
    SeededBuilder<kDims>{"Scale", &SeededBounds<kDims>::Scaled},
    SeededBuilder<kDims>{"Sweep", &SeededBounds<kDims>::Swept},
    SeededBuilder<kDims>{"Translate", &SeededBounds<kDims>::Translated},
    SeededBuilder<kDims>{"TranslateVertices",
                         &SeededBounds<kDims>::WithTranslatedVertices},
};

// Not in the scenes of seeded_scene.h, whose masks are constants, too.
template <int kDims>
inline constexpr std::array kSeededBuildersOfDoubles = {
    SeededBuilder<kDims>{"BoundCapsule of doubles",
                         &SeededBounds<kDims>::OfCapsuleInDouble},
    SeededBuilder<kDims>{"BoundOrientedBox of doubles",
                         &SeededBounds<kDims>::OfOrientedBoxInDouble},
    SeededBuilder<kDims>{"BoundRay of doubles",
                         &SeededBounds<kDims>::OfRayInDouble},
    SeededBuilder<kDims>{"BoundSegmentPieces of doubles",
                         &SeededBounds<kDims>::OfSegmentPiecesInDouble},
    SeededBuilder<kDims>{"BoundTransformed box of doubles",
                         &SeededBounds<kDims>::OfTransformedBoxInDouble},
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_SEEDED_BOUNDS_H_
