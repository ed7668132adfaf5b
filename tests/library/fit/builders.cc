#include "tests/library/fit/builders.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <iterator>
#include <utility>

namespace halfspace::testing {

std::size_t Builder::PlanesBut(Part none) const {
  return part == none ? 0 : part == Part::kAabb ? dims : dims + 1;
}

Planes Builder::Filled(float minimum) const {
  Planes planes{};
  float* plane = planes.data();
  for (std::size_t i = 0; i < results(); ++i) {
    plane = std::fill_n(plane, minima(), minimum);
    plane = std::fill_n(plane, maxima(), -minimum);
  }
  return planes;
}

std::size_t Builder::first_argument() const {
  switch (kind) {
    case Kind::kImageOfPoints:
      return kPointsOfSet * dims;
    case Kind::kImageOfBox:
      return 2 * dims;
    case Kind::kChange:
      return part == Part::kAabo   ? 2 * (dims + 1)
             : part == Part::kAabb ? 2 * dims
                                   : dims + 1;
    default:
      return roles.size();
  }
}

std::string Builder::Argument(std::size_t i) const {
  switch (kind) {
    case Kind::kSphere:
      return "sphere.radius";
    case Kind::kCapsule:
      return "capsule.radius";
    case Kind::kRay:
      return "ray.max_t";
    case Kind::kOrientedBox:
      return "box.half_extents[" + std::to_string(i - dims - dims * dims) + "]";
    case Kind::kChange:
      return change == Change::kInflate        ? "radius"
             : change == Change::kInflateByBox ? "margin"
                                               : "factor";
    default:
      return "box";
  }
}

std::vector<Builder> Builders(const std::vector<std::size_t>& all_dims) {
  std::vector<Builder> builders;
  for (std::size_t dims : all_dims) {
    for (bool is_double : {false, true}) {
      const std::string of = std::to_string(dims) + (is_double ? "Double" : "");
      const auto add =
          [&](Kind kind, std::string_view call,
              std::initializer_list<std::pair<Role, std::size_t>> numbers)
          -> Builder& {
        Builder& builder = builders.emplace_back(
            Builder{kind, call, std::string(call) + of, dims, is_double});
        for (const auto& [role, count] : numbers) {
          builder.roles.insert(builder.roles.end(), count, role);
        }
        return builder;
      };
      constexpr std::string_view kLayouts[] = {"", "Strided", "Soa", "Indexed",
                                               "IndexedSoa"};
      for (std::size_t layout = 0; layout < std::size(kLayouts); ++layout) {
        Builder& points = add(Kind::kPoints, "BoundPoints",
                              {{Role::kCoordinate, kPointsOfSet * dims}});
        points.layout = static_cast<PointLayout>(layout);
        points.name += kLayouts[layout];
      }
      add(Kind::kSegment, "BoundSegment", {{Role::kCoordinate, 2 * dims}});
      add(Kind::kTriangle, "BoundTriangle", {{Role::kCoordinate, 3 * dims}});
      add(Kind::kRay, "BoundRay",
          {{Role::kCoordinate, 2 * dims}, {Role::kLength, 1}});
      add(Kind::kPieces, "BoundSegmentPieces", {{Role::kCoordinate, 2 * dims}});
      add(Kind::kBox, "BoundAabb",
          {{Role::kMinimum, dims}, {Role::kMaximum, dims}});
      add(Kind::kOrientedBox, "BoundOrientedBox",
          {{Role::kCoordinate, dims + dims * dims}, {Role::kLength, dims}});
      add(Kind::kSphere, "BoundSphere",
          {{Role::kCoordinate, dims}, {Role::kLength, 1}});
      add(Kind::kCapsule, "BoundCapsule",
          {{Role::kCoordinate, 2 * dims}, {Role::kLength, 1}});
      for (bool is_map_double : {false, true}) {
        const char* const suffix = is_map_double ? "MapDouble" : "Map";
        Builder& points = add(
            Kind::kImageOfPoints, "BoundTransformed",
            {{Role::kCoordinate, kPointsOfSet * dims + dims * dims + dims}});
        points.is_map_double = is_map_double;
        points.name += std::string("Points") + suffix;
        Builder& box = add(Kind::kImageOfBox, "BoundTransformed",
                           {{Role::kMinimum, dims},
                            {Role::kMaximum, dims},
                            {Role::kCoordinate, dims * dims + dims}});
        box.is_map_double = is_map_double;
        box.name += std::string("Box") + suffix;
      }
    }
  }
  return builders;
}

std::vector<Builder> Changes(const std::vector<std::size_t>& all_dims) {
  struct Row {
    Change change;
    const char* call;
    Role role;
  };
  constexpr Row kRows[] = {
      {Change::kMerge, "Merge", Role::kCoordinate},
      {Change::kInflate, "Inflate", Role::kLength},
      {Change::kInflateByBox, "InflateByBox", Role::kLength},
      {Change::kTranslate, "Translate", Role::kCoordinate},
      {Change::kTranslateVertices, "TranslateVertices", Role::kCoordinate},
      {Change::kScale, "Scale", Role::kFactor},
      {Change::kSweep, "Sweep", Role::kCoordinate},
  };
  constexpr const char* kParts[] = {"Aabo", "Aabb", "Up", "Down"};
  std::vector<Builder> changes;
  for (std::size_t dims : all_dims) {
    for (const Row& row : kRows) {
      for (std::size_t part = 0; part < std::size(kParts); ++part) {
        const bool is_open = part >= 2;
        if (is_open && row.change == Change::kTranslateVertices) continue;
        Builder change{Kind::kChange, row.call,
                       row.call + std::to_string(dims) + kParts[part], dims};
        change.change = row.change;
        change.part = static_cast<Part>(part);
        const std::size_t planes = change.first_argument();
        const std::size_t arguments = row.change == Change::kMerge    ? planes
                                      : row.role == Role::kCoordinate ? dims
                                                                      : 1;
        const auto minima = static_cast<std::size_t>(part) == 3 ? 0
                            : part == 2                         ? planes
                                                                : planes / 2;
        change.roles.assign(minima, Role::kMinimum);
        change.roles.resize(planes, Role::kMaximum);
        change.roles.resize(planes + arguments, row.role);
        changes.push_back(change);
      }
    }
  }
  return changes;
}

const Builder& BuilderOf(Kind kind, std::size_t dims, bool is_double) {
  static const std::vector<Builder> all = Builders({2, 3, 4});
  return *std::find_if(all.begin(), all.end(), [&](const Builder& builder) {
    return builder.kind == kind && builder.dims == dims &&
           builder.is_double == is_double;
  });
}

Shape ShapeOfOnes(const Builder& builder) {
  Shape shape;
  for (std::size_t i = 0; i < builder.roles.size(); ++i) {
    shape.Set(i, 1.0);
    // A simplex that contains a point.
    if (builder.kind == Kind::kChange && builder.roles[i] == Role::kMinimum) {
      shape.Set(i, -1.0);
    }
  }
  return shape;
}

Shape SeededShape(const Builder& builder, SeededNumbers& numbers) {
  Shape shape;
  for (std::size_t i = 0; i < builder.roles.size(); ++i) {
    double number = numbers.Coordinate();
    if (builder.IsDouble(i)) {
      number += 0x1p-26 * double{numbers.WithExponent(-4, 3)};
    }
    switch (builder.roles[i]) {
      case Role::kLength:
        number = numbers.Length();
        break;
      case Role::kFactor:
        number = numbers.WithExponent(-4, 3);
        if (builder.part >= Part::kUp) number = std::fabs(number);
        break;
      case Role::kMaximum:
        // Not an inverted box.
        if (builder.kind != Kind::kChange) {
          const double min = shape.doubles[i - builder.dims];
          if (min > number) {
            shape.Set(i - builder.dims, number);
            number = min;
          }
        }
        break;
      default:
        break;
    }
    shape.Set(i, number);
  }
  return shape;
}

}  // namespace halfspace::testing
