// The calls of mesh.h.
#include "halfspace/mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <new>
#include <string>
#include <vector>

#include "dispatch/bvh/order.h"
#include "dispatch/bvh/scratch.h"
#include "dispatch/bvh/shape_query.h"
#include "dispatch/bvh/triangles.h"
#include "dispatch/default_fp_mode.h"
#include "dispatch/errors/error.h"
#include "dispatch/errors/memory_checks.h"
#include "dispatch/errors/number_checks.h"
#include "dispatch/outward.h"
#include "dispatch/targets/chosen_target.h"
#include "halfspace/detail/plane_arrays.h"
#include "kernels/bvh/mesh.h"

namespace halfspace {
namespace detail {

struct MeshState {
  explicit MeshState(const MemoryResource& its_memory)
      : memory(its_memory),
        nodes(BlockAllocator<MeshNode>(memory)),
        groups(BlockAllocator<MeshGroup>(memory)) {}

  MemoryResource memory;
  std::size_t size = 0;  // triangles
  MeshRef root = 0;
  MeshCube cube;
  BlockVector<MeshNode> nodes;
  BlockVector<MeshGroup> groups;  // none without a finite triangle

  MeshTree tree() const { return {nodes.data(), groups.data(), root, cube}; }
};

}  // namespace detail

namespace {

using detail::kMeshLanes;
using detail::MeshGroup;
using detail::MeshRef;
using detail::MeshState;

constexpr std::size_t kDims = 3;
constexpr float kInf = std::numeric_limits<float>::infinity();

Triangle<3> TriangleAt(const MeshGroup& group, std::size_t lane) {
  Triangle<3> triangle;
  for (std::size_t k = 0; k < kDims; ++k) {
    triangle.a[k] = group.corners[k][lane];
    triangle.b[k] = group.corners[kDims + k][lane];
    triangle.c[k] = group.corners[2 * kDims + k][lane];
  }
  return triangle;
}

struct Bounds {
  Point<3> min = {kInf, kInf, kInf};
  Point<3> max = {-kInf, -kInf, -kInf};

  void Add(const Point<3>& point) {
    for (std::size_t k = 0; k < kDims; ++k) {
      min[k] = std::min(min[k], point[k]);
      max[k] = std::max(max[k], point[k]);
    }
  }
  void Add(const Bounds& other) {
    for (std::size_t k = 0; k < kDims; ++k) {
      min[k] = std::min(min[k], other.min[k]);
      max[k] = std::max(max[k], other.max[k]);
    }
  }
  // Half of the surface area. 0 if it is empty.
  double Area() const {
    if (min[0] > max[0]) return 0.0;
    const double x = double{max[0]} - min[0];
    const double y = double{max[1]} - min[1];
    const double z = double{max[2]} - min[2];
    return x * y + y * z + z * x;
  }
  double Center(std::size_t k) const { return 0.5 * (double{min[k]} + max[k]); }
  detail::MeshCube Cube() const {
    detail::MeshCube cube = {};
    for (std::size_t k = 0; k < kDims; ++k) {
      const auto center = static_cast<float>(Center(k));
      cube.center[k] = center;
      cube.half = std::max({cube.half,
                            dispatch::RoundUpLoosely(double{max[k]} - center),
                            dispatch::RoundUpLoosely(double{center} - min[k])});
    }
    return cube;
  }
};

// The corners of triangles: of a list of vertices, three of which are one after
// another if there are no indices.
struct Corners {
  const Point<3>* vertices;
  const std::uint32_t* indices;

  const Point<3>& At(std::size_t i) const {
    return vertices[indices == nullptr ? i : indices[i]];
  }
};

struct Entry {
  Bounds bounds;
  std::uint32_t id;
};

struct Piece {
  Entry* begin;
  Entry* end;
  Bounds bounds;

  std::size_t size() const { return static_cast<std::size_t>(end - begin); }
};

Piece PieceOf(Entry* begin, Entry* end) {
  Piece piece = {begin, end, {}};
  for (const Entry* e = begin; e != end; ++e) piece.bounds.Add(e->bounds);
  return piece;
}

class Builder {
 public:
  Builder(const Corners& corners, MeshState& mesh)
      : corners_(corners), mesh_(mesh) {}

  void Build() {
    detail::BlockVector<Entry> entries{
        detail::BlockAllocator<Entry>(mesh_.memory)};
    entries.reserve(mesh_.size);
    for (std::size_t i = 0; i < mesh_.size; ++i) {
      Entry entry = {{}, static_cast<std::uint32_t>(i)};
      float sum = 0;  // 0 or NaN
      for (std::size_t c = 0; c < 3; ++c) {
        const Point<3>& corner = corners_.At(3 * i + c);
        entry.bounds.Add(corner);
        for (float x : corner) sum += x * 0;
      }
      if (sum == 0) entries.push_back(entry);
    }
    if (entries.empty()) return;
    const Piece all = PieceOf(entries.data(), entries.data() + entries.size());
    mesh_.cube = all.bounds.Cube();
    mesh_.root = Add(all, 0);
    mesh_.nodes.shrink_to_fit();
    mesh_.groups.shrink_to_fit();
  }

 private:
  static MeshRef RefOf(std::size_t index, std::size_t lanes) {
    return static_cast<MeshRef>(index | (lanes - 1) << detail::kMeshIndexBits);
  }

  MeshRef Add(const Piece& piece, std::size_t depth) {
    if (piece.size() <= kMeshLanes) return AddGroup(piece);
    std::array<Piece, kMeshLanes> pieces;
    std::size_t count = 1;
    pieces[0] = piece;
    const bool is_even = depth >= detail::kMeshDepth;
    while (count < kMeshLanes) {
      Piece* const most =
          std::max_element(pieces.data(), pieces.data() + count,
                           [&](const Piece& a, const Piece& b) {
                             return WorthOf(a, is_even) < WorthOf(b, is_even);
                           });
      if (most->size() <= kMeshLanes) break;
      Entry* const middle =
          is_even ? most->begin + most->size() / 2 : Split(*most);
      pieces[count++] = PieceOf(middle, most->end);
      *most = PieceOf(most->begin, middle);
    }
    const std::size_t index = mesh_.nodes.size();
    mesh_.nodes.emplace_back();
    for (std::size_t i = 0; i < kMeshLanes; ++i) {
      const Bounds bounds = i < count ? pieces[i].bounds : Bounds();
      const MeshRef child = i < count ? Add(pieces[i], depth + 1) : 0;
      detail::MeshNode& node = mesh_.nodes[index];
      node.child[i] = child;
      for (std::size_t k = 0; k < kDims; ++k) {
        node.planes[k][i] = bounds.min[k];
        node.planes[kDims + k][i] = bounds.max[k];
      }
    }
    return RefOf(index, count);
  }

  // The piece of the greatest worth is split next.
  static double WorthOf(const Piece& piece, bool is_even) {
    if (piece.size() <= kMeshLanes) return -1.0;
    return is_even ? static_cast<double>(piece.size()) : piece.bounds.Area();
  }

  MeshRef AddGroup(const Piece& piece) {
    MeshGroup group;
    group.are_points = 0;
    for (std::size_t i = 0; i < kMeshLanes; ++i) {
      // Lanes without a triangle are not used.
      group.id[i] = piece.begin[std::min(i, piece.size() - 1)].id;
      for (std::size_t v = 0; v < 3 * kDims; ++v) {
        group.corners[v][i] =
            corners_.At(std::size_t{3} * group.id[i] + v / kDims)[v % kDims];
      }
      const Triangle<3> triangle = TriangleAt(group, i);
      const bool is_point =
          triangle.a == triangle.b && triangle.a == triangle.c;
      group.are_points |= std::uint32_t{is_point} << i;
    }
    group.cube = piece.bounds.Cube();
    mesh_.groups.push_back(group);
    return RefOf(mesh_.groups.size() - 1, piece.size()) | detail::kMeshGroupBit;
  }

  // Groups of centers, in order along an axis.
  struct Bins {
    static constexpr std::size_t kCount = 32;
    std::array<Bounds, kCount> bounds;
    std::array<std::size_t, kCount> counts{};
  };
  struct Cut {
    std::size_t axis;
    double from;
    double scale;         // bins of a unit
    std::size_t bin = 0;  // the first of the upper part, or 0 without a cut

    std::size_t BinOf(const Entry& entry) const {
      return std::min(
          static_cast<std::size_t>((entry.bounds.Center(axis) - from) * scale),
          Bins::kCount - 1);
    }
  };

  // Reorders the triangles of a piece, and returns where the upper part begins.
  static Entry* Split(const Piece& piece) {
    std::array<double, kDims> least;
    std::array<double, kDims> most;
    least.fill(std::numeric_limits<double>::infinity());
    most.fill(-std::numeric_limits<double>::infinity());
    for (const Entry* e = piece.begin; e != piece.end; ++e) {
      for (std::size_t k = 0; k < kDims; ++k) {
        least[k] = std::min(least[k], e->bounds.Center(k));
        most[k] = std::max(most[k], e->bounds.Center(k));
      }
    }
    Cut best = {};
    double best_cost = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < kDims; ++k) {
      const double scale = Bins::kCount / (most[k] - least[k]);
      if (!(scale <= std::numeric_limits<double>::max())) continue;
      Cut cut = {k, least[k], scale};
      Bins bins;
      for (const Entry* e = piece.begin; e != piece.end; ++e) {
        const std::size_t bin = cut.BinOf(*e);
        bins.bounds[bin].Add(e->bounds);
        ++bins.counts[bin];
      }
      const double cost = BestOf(bins, piece.size(), cut);
      if (cost < best_cost) {
        best_cost = cost;
        best = cut;
      }
    }
    if (best.bin == 0) return piece.begin + piece.size() / 2;
    return detail::Partition(piece.begin, piece.end, [&](const Entry& entry) {
      return best.BinOf(entry) < best.bin;
    });
  }

  // Finds the bin that the upper part should begin with, and the cost: the
  // groups of each part, weighted by its area.
  static double BestOf(const Bins& bins, std::size_t size, Cut& cut) {
    const auto cost_of = [](const Bounds& bounds, std::size_t count) {
      const std::size_t groups = (count + kMeshLanes - 1) / kMeshLanes;
      return bounds.Area() * static_cast<double>(groups);
    };
    std::array<double, Bins::kCount> above;
    Bounds bounds;
    std::size_t count = 0;
    for (std::size_t bin = Bins::kCount; bin-- > 1;) {
      bounds.Add(bins.bounds[bin]);
      count += bins.counts[bin];
      above[bin] = cost_of(bounds, count);
    }
    bounds = {};
    count = 0;
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t bin = 1; bin < Bins::kCount; ++bin) {
      bounds.Add(bins.bounds[bin - 1]);
      count += bins.counts[bin - 1];
      const double cost = cost_of(bounds, count) + above[bin];
      if (count != 0 && count != size && cost < best) {
        best = cost;
        cut.bin = bin;
      }
    }
    return best;
  }

  const Corners& corners_;
  MeshState& mesh_;
};

void Destroy(MeshState* mesh) {
  if (mesh == nullptr) return;
  const MemoryResource memory = mesh->memory;
  mesh->~MeshState();
  detail::FreeBlock(memory, mesh, sizeof(MeshState));
}

MeshState* Make(const Corners& corners, std::size_t size,
                const MemoryResource& memory) {
  if (size >> detail::kMeshIndexBits != 0) {
    dispatch::ThrowInvalid("TriangleMesh", "triangles", "fewer than 2^27",
                           std::to_string(size));
  }
  auto* const mesh =
      new (detail::AllocateBlock(memory, sizeof(MeshState))) MeshState(memory);
  mesh->size = size;
#if defined(__cpp_exceptions)
  try {
#endif
    dispatch::InDefaultFpMode([&] { Builder(corners, *mesh).Build(); });
#if defined(__cpp_exceptions)
  } catch (...) {
    Destroy(mesh);
    throw;
  }
#endif
  return mesh;
}

bool IsFinite(const Point<3>& point) {
  return std::isfinite(point[0]) && std::isfinite(point[1]) &&
         std::isfinite(point[2]);
}

template <typename Element, typename Result>
void CheckQueries(const char* call, const char* name, Span<const Element> list,
                  const char* results_name, Span<Result> results) {
  dispatch::CheckMemory(call, name, list.data(), list.size(), alignof(Element));
  dispatch::CheckMemory(call, results_name, results.data(), results.size(),
                        alignof(Result));
  if (results.size() != list.size()) {
    dispatch::ThrowInvalid(
        call, results_name,
        "as many as " + std::string(name) + ", " + std::to_string(list.size()),
        std::to_string(results.size()));
  }
}

const detail::MeshKernels& KernelsFor(Target target, const char* call) {
  return detail::KernelsOfAll<detail::MeshKernels>::kTargets[dispatch::IndexOf(
      target, call)];
}

// Calls Answer(group, lane) of `answer` for each triangle that the ray may hit.
template <typename Answer>
void Cast(const MeshState* mesh, const detail::MeshKernels& kernels,
          const Ray<3>& ray, Answer& answer) {
  if (mesh == nullptr || mesh->groups.empty()) return;
  if (!IsFinite(ray.origin) || !IsFinite(ray.direction)) return;
  const detail::MeshTree tree = mesh->tree();
  detail::MeshCast cast;
  cast.tree = &tree;
  double from[kDims];
  double direction[kDims];
  std::size_t axis = 0;
  for (std::size_t k = 0; k < kDims; ++k) {
    from[k] = ray.origin[k];
    direction[k] = ray.direction[k];
    cast.origin[k] = ray.origin[k];
    if (std::fabs(direction[k]) > std::fabs(direction[axis])) axis = k;
  }
  if (direction[axis] == 0) return;
  for (std::size_t k = 0; k < kDims; ++k) {
    cast.axis[k] = (axis + 1 + k) % kDims;
  }
  for (std::size_t k = 0; k < 2; ++k) {
    cast.shear[k] =
        static_cast<float>(direction[cast.axis[k]] / direction[axis]);
  }
  cast.speed = ray.direction[axis];
  MakeLine(detail::kLayoutOf<Aabb3>, from, from, direction, ray.max_t, 0,
           cast.line);
  cast.line.max_t = std::min(ray.max_t, std::numeric_limits<float>::max());
  cast.function = [](void* context, const MeshGroup& group, std::size_t lane) {
    return static_cast<Answer*>(context)->Take(group, lane);
  };
  cast.context = &answer;
  kernels.cast(cast);
}

struct FirstAnswer {
  Ray<3> ray;  // up to the first hit
  MeshHit hit = {kNoId, kInf};

  float Take(const MeshGroup& group, std::size_t lane) {
    const float t = detail::HitOf(ray, TriangleAt(group, lane));
    if (t < hit.t || (t == hit.t && t < kInf && group.id[lane] < hit.id)) {
      hit = {group.id[lane], t};
      ray.max_t = t;
    }
    return hit.t;
  }
};

struct AnyAnswer {
  const Ray<3>& ray;
  bool is_hit = false;

  float Take(const MeshGroup& group, std::size_t lane) {
    is_hit = detail::HitOf(ray, TriangleAt(group, lane)) < kInf;
    return is_hit ? -1.0f : kInf;
  }
};

struct EachAnswer {
  Ray<3> ray;
  detail::MeshHitFunction function;
  void* context;
  dispatch::DefaultFpMode& mode;

  float Take(const MeshGroup& group, std::size_t lane) {
    const float t = detail::HitOf(ray, TriangleAt(group, lane));
    if (!(t < kInf)) return kInf;
    const float limit =
        mode.Outside([&] { return function(context, group.id[lane], t); });
    if (limit < ray.max_t) ray.max_t = limit;
    return limit;
  }
};

struct ClosestAnswer {
  const Point<3>& point;
  float max_distance;
  MeshPoint closest;

  float Take(const MeshGroup& group, std::size_t lane) {
    const TrianglePoint found =
        detail::ClosestOf(point, TriangleAt(group, lane));
    const std::uint32_t id = group.id[lane];
    if (found.distance <= max_distance &&
        (found.distance < closest.distance ||
         (found.distance == closest.distance && found.distance < kInf &&
          id < closest.id))) {
      closest = {id, found.distance, found.point};
    }
    return closest.distance;
  }

  static float Run(void* answer, const MeshGroup& group, std::size_t lane) {
    return static_cast<ClosestAnswer*>(answer)->Take(group, lane);
  }
};

void CheckRays(const char* call, Span<const Ray<3>> rays) {
  for (const Ray<3>& ray : rays) {
    dispatch::CheckLength(call, "max_t", ray.max_t);
  }
}

}  // namespace

TriangleMesh::TriangleMesh(Span<const Point<3>> vertices,
                           Span<const std::uint32_t> indices,
                           const MemoryResource& memory) {
  constexpr const char* kCall = "TriangleMesh";
  dispatch::CheckMemory(kCall, "vertices", vertices.data(), vertices.size(),
                        alignof(float));
  dispatch::CheckMemory(kCall, "indices", indices.data(), indices.size(),
                        alignof(std::uint32_t));
  if (indices.size() % 3 != 0) {
    dispatch::ThrowInvalid(kCall, "indices", "3 for each triangle",
                           std::to_string(indices.size()));
  }
  for (std::size_t i = 0; i < indices.size(); ++i) {
    if (indices[i] >= vertices.size()) {
      dispatch::ThrowInvalid(kCall, "indices",
                             "less than " + std::to_string(vertices.size()) +
                                 ", the number of vertices",
                             std::to_string(indices[i]), i);
    }
  }
  state_ = Make({vertices.data(), indices.data()}, indices.size() / 3, memory);
}

TriangleMesh::TriangleMesh(Span<const Triangle<3>> triangles,
                           const MemoryResource& memory) {
  static_assert(sizeof(Triangle<3>) == 3 * sizeof(Point<3>));
  dispatch::CheckMemory("TriangleMesh", "triangles", triangles.data(),
                        triangles.size(), alignof(float));
  state_ = Make({reinterpret_cast<const Point<3>*>(triangles.data()), nullptr},
                triangles.size(), memory);
}

TriangleMesh::~TriangleMesh() { Destroy(state_); }

std::size_t TriangleMesh::size() const {
  return state_ == nullptr ? 0 : state_->size;
}

std::size_t TriangleMesh::bytes() const {
  if (state_ == nullptr) return 0;
  return sizeof(MeshState) +
         state_->nodes.capacity() * sizeof(detail::MeshNode) +
         state_->groups.capacity() * sizeof(MeshGroup);
}

void TriangleMesh::FirstHits(Span<const Ray<3>> rays, Span<MeshHit> hits,
                             Target target) const {
  constexpr const char* kCall = "FirstHits";
  CheckQueries(kCall, "rays", rays, "hits", hits);
  CheckRays(kCall, rays);
  const detail::MeshKernels& kernels = KernelsFor(target, kCall);
  dispatch::InDefaultFpMode([&] {
    for (std::size_t i = 0; i < rays.size(); ++i) {
      FirstAnswer answer = {rays[i]};
      Cast(state_, kernels, rays[i], answer);
      hits[i] = answer.hit;
    }
  });
}

void TriangleMesh::Occluded(Span<const Ray<3>> rays, Span<bool> is_hit,
                            Target target) const {
  constexpr const char* kCall = "Occluded";
  CheckQueries(kCall, "rays", rays, "is_hit", is_hit);
  CheckRays(kCall, rays);
  const detail::MeshKernels& kernels = KernelsFor(target, kCall);
  dispatch::InDefaultFpMode([&] {
    for (std::size_t i = 0; i < rays.size(); ++i) {
      AnyAnswer answer = {rays[i]};
      Cast(state_, kernels, rays[i], answer);
      is_hit[i] = answer.is_hit;
    }
  });
}

void TriangleMesh::CallForHits(const Ray<3>& ray,
                               detail::MeshHitFunction function, void* context,
                               Target target) const {
  constexpr const char* kCall = "ForEachHit";
  CheckRays(kCall, {&ray, 1});
  const detail::MeshKernels& kernels = KernelsFor(target, kCall);
  dispatch::DefaultFpMode mode;
  EachAnswer answer = {ray, function, context, mode};
  dispatch::CallApart([&] { Cast(state_, kernels, ray, answer); });
}

void TriangleMesh::ClosestPoints(Span<const Point<3>> points,
                                 Span<MeshPoint> results, float max_distance,
                                 Target target) const {
  constexpr const char* kCall = "ClosestPoints";
  CheckQueries(kCall, "points", points, "results", results);
  dispatch::CheckLength(kCall, "max_distance", max_distance);
  const detail::MeshKernels& kernels = KernelsFor(target, kCall);
  dispatch::InDefaultFpMode([&] {
    constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
    for (std::size_t i = 0; i < points.size(); ++i) {
      ClosestAnswer answer = {
          points[i], max_distance, {kNoId, kInf, {kNaN, kNaN, kNaN}}};
      if (state_ != nullptr && !state_->groups.empty() && IsFinite(points[i])) {
        const detail::MeshTree tree = state_->tree();
        const Point<3>& at = points[i];
        kernels.nearest({&tree,
                         {at[0], at[1], at[2]},
                         max_distance,
                         &ClosestAnswer::Run,
                         &answer});
      }
      results[i] = answer.closest;
    }
  });
}

}  // namespace halfspace
