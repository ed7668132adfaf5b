// The three shapes, as the benchmarks name and view them in one world of
// octahedra.
#ifndef HALFSPACE_BENCH_BASE_SHAPE_H_
#define HALFSPACE_BENCH_BASE_SHAPE_H_

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "halfspace/bounds.h"
#include "halfspace/reject.h"
#include "halfspace/world.h"

namespace halfspace::bench {

enum class ShapeKind : std::size_t { kAabb, kSimplex, kAabo };

inline constexpr std::array<ShapeKind, 3> kShapes = {
    ShapeKind::kAabb, ShapeKind::kSimplex, ShapeKind::kAabo};

// One number for each shape.
template <typename T>
struct PerShape {
  T aabb{};
  T simplex{};
  T aabo{};

  T& Of(ShapeKind shape) {
    return shape == ShapeKind::kAabb      ? aabb
           : shape == ShapeKind::kSimplex ? simplex
                                          : aabo;
  }
  const T& Of(ShapeKind shape) const {
    return shape == ShapeKind::kAabb      ? aabb
           : shape == ShapeKind::kSimplex ? simplex
                                          : aabo;
  }
};

constexpr const char* NameOf(ShapeKind shape) {
  constexpr const char* kNames[] = {"AABB", "simplex", "AABO"};
  return kNames[static_cast<std::size_t>(shape)];
}

constexpr std::size_t PlaneCountOf(ShapeKind shape) {
  constexpr std::size_t kCounts[] = {6, 4, 8};
  return kCounts[static_cast<std::size_t>(shape)];
}

// Calls f(view, query) with the shape's own view of the octahedra.
template <int kDims, typename F>
auto WithShape(ShapeKind shape, const AaboView<kDims>& view,
               const Aabo<kDims>& query, F&& f) {
  switch (shape) {
    case ShapeKind::kAabb:
      return f(view.aabb(), query.aabb());
    case ShapeKind::kSimplex:
      return f(view.simplex(), query.down());
    case ShapeKind::kAabo:
      break;
  }
  return f(view, query);
}

// The shape's planes in the kernels' order: all minima, then all maxima.
inline std::vector<const float*> PlanesOf(ShapeKind shape,
                                          const AaboView3& view) {
  const std::size_t axes = shape == ShapeKind::kAabb ? 3 : 4;
  std::vector<const float*> planes(view.min.begin(), view.min.begin() + axes);
  if (shape != ShapeKind::kSimplex) {
    planes.insert(planes.end(), view.max.begin(), view.max.begin() + axes);
  }
  return planes;
}

// The query's values in the kernels' order.
inline std::vector<float> QueryOf(ShapeKind shape, const Aabo3& query) {
  const std::size_t axes = shape == ShapeKind::kAabb ? 3 : 4;
  std::vector<float> values;
  if (shape != ShapeKind::kSimplex) {
    values.assign(query.min.begin(), query.min.begin() + axes);
  }
  values.insert(values.end(), query.max.begin(), query.max.begin() + axes);
  return values;
}

// The schedules by name, and those that differ for a shape.
struct NamedSchedule {
  const char* name;
  Schedule schedule;
};

inline constexpr std::array<NamedSchedule, 4> kSchedules = {
    {{"flat", Schedule::kFlat},
     {"staged", Schedule::kStaged},
     {"by-axis", Schedule::kStagedByAxis},
     {"auto", Schedule::kAuto}}};

// A simplex has one stage.
constexpr std::span<const NamedSchedule> SchedulesOf(ShapeKind shape) {
  constexpr std::array<std::size_t, kShapes.size()> kCounts = {4, 1, 4};
  return std::span(kSchedules).first(kCounts[static_cast<std::size_t>(shape)]);
}

// Queries as each of the three shapes, in arrays for calls with many queries.
class ShapeQueries {
 public:
  explicit ShapeQueries(std::span<const Aabo3> queries)
      : aabos_(queries.begin(), queries.end()) {
    for (const Aabo3& query : aabos_) {
      boxes_.push_back(query.aabb());
      simplices_.push_back(query.down());
    }
  }

  std::size_t size() const { return aabos_.size(); }
  std::span<const Aabo3> aabos() const { return aabos_; }
  std::span<const DownSimplex3> simplices() const { return simplices_; }

  // Calls f(view, queries) with the shape's own view of the octahedra.
  template <typename F>
  auto With(ShapeKind shape, const AaboView3& view, F&& f) const {
    switch (shape) {
      case ShapeKind::kAabb:
        return f(view.aabb(), std::span<const Aabb3>(boxes_));
      case ShapeKind::kSimplex:
        return f(view.simplex(), simplices());
      case ShapeKind::kAabo:
        break;
    }
    return f(view, aabos());
  }

 private:
  std::vector<Aabo3> aabos_;
  std::vector<Aabb3> boxes_;
  std::vector<DownSimplex3> simplices_;
};

// Adds the survivors of one query.
template <int kDims, typename T>
void AddSurvivors(const AaboView<kDims>& view, const Aabo<kDims>& query,
                  PerShape<T>& sums) {
  for (ShapeKind shape : kShapes) {
    sums.Of(shape) += static_cast<T>(
        WithShape(shape, view, query, [](const auto& objects, const auto& of) {
          return CountSurvivors(objects, of);
        }));
  }
}

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_BASE_SHAPE_H_
