// hs_bvh_...() and hs_broad_phase_...() that find objects: queries, nearest,
// casts. Each is one template, as the two have the same arguments.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "c/broad_phase.h"
#include "c/bvh.h"
#include "c/call.h"
#include "c/columns.h"
#include "halfspace/bvh.h"
#include "halfspace/bvh_nearest.h"
#include "halfspace/bvh_shapes.h"
#include "halfspace/frustum.h"

namespace halfspace::c {
namespace {

constexpr hs_query_options kQueryDefaults = {
    sizeof(hs_query_options), 0xFFFFFFFF, HS_SHAPE_BOUND, 0, nullptr, 0};

static_assert(HS_NO_ID == detail::kNoId);

// Queries, after their checks.
struct Queries {
  template <typename Tree>
  Queries(const Call& call, const Tree* tree, const hs_columns* queries,
          const hs_query_options* options) {
    call.CheckPointer(kName<Tree>, tree);
    const hs_query_options read =
        ReadOptions(call, "options", options, kQueryDefaults);
    search.mask = read.mask;
    search.target = ReadTarget(call, "options", read.target);
    skip = read.skip;
    const std::size_t dims = tree->layout.dims;
    switch (read.shape) {
      case HS_SHAPE_BOUND:
        if constexpr (kIsBvh<Tree>) {
          values = tree->queries;
        } else {
          values = tree->objects;
        }
        break;
      case HS_SHAPE_POINT:
        values = Values::OfColumns(dims);
        kind = dims == 2 ? &detail::kShapeKind<AabbView2, Point<2>>
                         : &detail::kShapeKind<AabbView3, Point<3>>;
        break;
      case HS_SHAPE_SPHERE:
        values = Values::OfColumns(dims + 1);
        kind = dims == 2 ? &detail::kShapeKind<AabbView2, Sphere<2>>
                         : &detail::kShapeKind<AabbView3, Sphere<3>>;
        break;
      case HS_SHAPE_ROUNDED_BOX:
        values = Values::OfColumns(2 * dims + 1);
        kind = dims == 2 ? &detail::kShapeKind<AabbView2, RoundedBox<2>>
                         : &detail::kShapeKind<AabbView3, RoundedBox<3>>;
        break;
      case HS_SHAPE_HALF_SPACES:
        values = Values::OfColumns(dims + 1);
        kind = dims == 2
                   ? &detail::kShapeKind<AabbView2, Span<const HalfSpace<2>>>
                   : &detail::kShapeKind<AabbView3, Span<const HalfSpace<3>>>;
        break;
      default:
        call.Fail(HS_INVALID_ARGUMENT, "options->shape",
                  "expected an enumerator of hs_shape, got %d",
                  static_cast<int>(read.shape));
    }
    CheckColumns(call, "queries", queries, values);
    if (kind != nullptr) CheckFloats(call, "queries", *queries);
    columns = queries;
    query_count = queries->count;
    if (read.shape == HS_SHAPE_HALF_SPACES) ReadHalfSpaces(call, dims);
  }

  // Those from row q on.
  detail::BvhQueries From(const float* rows, std::size_t q,
                          std::size_t count = 1) const {
    return {rows + q * values.count, count, kind};
  }
  // Calls run(rows, begin, count).
  template <typename Function>
  void ForEach(const Function& run) const {
    if (list != nullptr) {
      run(static_cast<const float*>(list), 0, 1);
    } else {
      ForEachRows(*columns, values, run);
    }
  }

  QueryOptions search;
  std::size_t skip;
  Values values;
  const detail::BvhShapeKind* kind = nullptr;
  const hs_columns* columns = nullptr;
  std::size_t query_count;

 private:
  // All rows are one query.
  void ReadHalfSpaces(const Call& call, std::size_t dims) {
    if (columns->count > detail::kMostHalfSpaces) {
      call.Fail(HS_INVALID_ARGUMENT, "queries->count",
                "expected at most %zu half-spaces, got %zu",
                detail::kMostHalfSpaces, columns->count);
    }
    ForEachRows(*columns, values,
                [&](const float* rows, std::size_t, std::size_t some) {
                  std::copy_n(rows, some * values.count, half_spaces.data());
                });
    query_count = 1;
    if (dims == 2) {
      of_2 = {reinterpret_cast<const HalfSpace<2>*>(half_spaces.data()),
              columns->count};
      list = &of_2;
    } else {
      of_3 = {reinterpret_cast<const HalfSpace<3>*>(half_spaces.data()),
              columns->count};
      list = &of_3;
    }
  }

  std::array<float, 4 * detail::kMostHalfSpaces> half_spaces;
  Span<const HalfSpace<2>> of_2;
  Span<const HalfSpace<3>> of_3;
  const void* list = nullptr;  // one of the two
};

SearchOptions ReadSearch(const Call& call, const hs_query_options* options) {
  const hs_query_options read =
      ReadOptions(call, "options", options, kQueryDefaults);
  return {read.mask, ReadTarget(call, "options", read.target),
          read.exclusive != 0};
}

void CheckLength(const Call& call, const char* argument, float length) {
  if (length >= 0) return;
  call.Fail(HS_INVALID_ARGUMENT, argument,
            "expected a number that is not negative, got %s",
            detail::NumberText(length).c_str());
}

template <typename Tree>
hs_status Query(const char* name, const Tree* tree, const hs_columns* columns,
                const hs_query_options* options, std::uint32_t* ids,
                std::size_t room, std::size_t* offsets, std::size_t* total) {
  return Run(name, [&](const Call& call) {
    const Queries queries(call, tree, columns, options);
    call.CheckArray("ids", ids, room);
    call.CheckPointer("total", total);
    std::size_t own_offsets[kMostRows + 1];
    if (offsets != nullptr) {
      call.CheckPointer("offsets", offsets);
      offsets[0] = 0;
    }
    ResultRoom<std::uint32_t> results(ids, room, queries.skip);
    queries.ForEach(
        [&](const float* rows, std::size_t begin, std::size_t count) {
          if constexpr (kIsBvh<Tree>) {
            if (count > 1) {
              std::size_t* const to =
                  offsets != nullptr ? offsets + begin : own_offsets;
              const std::size_t before = results.total();
              results.Add(tree->core.SurvivorsOfEach(
                  queries.From(rows, 0, count), results.span(), {to, count + 1},
                  queries.search, results.skip()));
              for (std::size_t i = 0; i <= count; ++i) to[i] += before;
              return;
            }
          }
          // Together they would need a copy of the tree while bodies move.
          for (std::size_t q = 0; q < count; ++q) {
            const detail::BvhQueries query = queries.From(rows, q);
            results.Add(tree->core.Survivors(query, results.span(),
                                             queries.search, results.skip()));
            if (offsets != nullptr) offsets[begin + q + 1] = results.total();
          }
        });
    *total = results.total();
  });
}

template <typename Tree>
hs_status CountAll(const char* name, const Tree* tree,
                   const hs_columns* columns, const hs_query_options* options,
                   std::size_t* counts) {
  return Run(name, [&](const Call& call) {
    const Queries queries(call, tree, columns, options);
    call.CheckArray("counts", counts, queries.query_count);
    queries.ForEach(
        [&](const float* rows, std::size_t begin, std::size_t count) {
          if constexpr (kIsBvh<Tree>) {
            if (queries.kind == nullptr) {
              tree->core.CountOfEach(queries.From(rows, 0, count),
                                     {counts + begin, count}, queries.search);
              return;
            }
          }
          for (std::size_t q = 0; q < count; ++q) {
            const detail::BvhQueries query = queries.From(rows, q);
            counts[begin + q] = tree->core.Count(query, queries.search);
          }
        });
  });
}

template <typename Tree>
hs_status AnyOfEach(const char* name, const Tree* tree,
                    const hs_columns* columns, const hs_query_options* options,
                    std::uint32_t* ids) {
  return Run(name, [&](const Call& call) {
    const Queries queries(call, tree, columns, options);
    call.CheckArray("ids", ids, queries.query_count);
    queries.ForEach(
        [&](const float* rows, std::size_t begin, std::size_t count) {
          for (std::size_t q = 0; q < count; ++q) {
            const detail::BvhQueries query = queries.From(rows, q);
            std::uint32_t& id = ids[begin + q];
            id = HS_NO_ID;
            tree->core.Any(query, id, queries.search);
          }
        });
  });
}

// Calls the function of a query.
template <typename Tree>
class EachQuery {
 public:
  EachQuery(const Tree& tree, const Queries& queries, hs_ids_function function,
            void* context)
      : tree_(tree),
        queries_(queries),
        function_(function),
        context_(context) {}

  void Run(const float* rows, std::size_t begin, std::size_t count) {
    for (std::size_t q = 0; q < count && !is_stopped_; q += kTogether) {
      const std::size_t some = std::min(count - q, kTogether);
      if (is_one_by_one_ || some == 1 || !RunTogether(rows, begin, q, some)) {
        RunOneByOne(rows, begin, q, some);
      }
    }
  }

 private:
  // So many queries walk the tree together, which takes half of the time of one
  // walk each, or less.
  static constexpr std::size_t kTogether = 64;
  static constexpr std::size_t kRoom = 4096;

  // Returns false if there are more ids than room. Then the next queries do not
  // try.
  bool RunTogether(const float* rows, std::size_t begin, std::size_t first,
                   std::size_t count) {
    if constexpr (kIsBvh<Tree>) {
      std::array<std::uint32_t, kRoom> ids;
      std::array<std::size_t, kTogether + 1> offsets;
      const std::size_t found = tree_.core.SurvivorsOfEach(
          queries_.From(rows, first, count), {ids.data(), ids.size()},
          {offsets.data(), count + 1}, queries_.search, 0);
      is_one_by_one_ = found > ids.size();
      if (is_one_by_one_) return false;
      for (std::size_t q = 0; q < count && !is_stopped_; ++q) {
        if (offsets[q] == offsets[q + 1]) continue;
        Call(begin + first + q,
             {ids.data() + offsets[q], offsets[q + 1] - offsets[q]});
      }
    }
    return kIsBvh<Tree>;
  }

  void RunOneByOne(const float* rows, std::size_t begin, std::size_t first,
                   std::size_t count) {
    for (std::size_t q = first; q < first + count && !is_stopped_; ++q) {
      detail::Callback call{[&](Span<const std::uint32_t> ids) {
        Call(begin + q, ids);
        return !is_stopped_;
      }};
      const detail::BvhQueries query = queries_.From(rows, q);
      tree_.core.ForEach(query, &decltype(call)::Run, &call, queries_.search);
    }
  }

  void Call(std::size_t query, Span<const std::uint32_t> ids) {
    is_stopped_ =
        function_(context_, query, ids.data(), ids.size()) != HS_CONTINUE;
  }

  const Tree& tree_;
  const Queries& queries_;
  hs_ids_function function_;
  void* context_;
  bool is_one_by_one_ = false;
  bool is_stopped_ = false;
};

template <typename Tree>
hs_status QueryEach(const char* name, const Tree* tree,
                    const hs_columns* columns, const hs_query_options* options,
                    hs_ids_function function, void* context) {
  return Run(name, [&](const Call& call) {
    const Queries queries(call, tree, columns, options);
    call.CheckPointer("function", function);
    EachQuery<Tree> each(*tree, queries, function, context);
    queries.ForEach([&](const float* rows, std::size_t begin,
                        std::size_t count) { each.Run(rows, begin, count); });
  });
}

// For a box that is inverted, the library finds any objects. Points are boxes
// that are not.
void CheckBoxes(const Call& call, const float* rows, std::size_t begin,
                std::size_t count, std::size_t dims) {
  for (std::size_t i = 0; i < count; ++i) {
    const float* const min = rows + i * 2 * dims;
    const float* const max = min + dims;
    bool is_empty = true;
    std::size_t wrong = dims;
    for (std::size_t k = 0; k < dims; ++k) {
      is_empty &= min[k] == INFINITY && max[k] == -INFINITY;
      if (min[k] > max[k]) wrong = k;
    }
    if (wrong == dims || is_empty) continue;
    call.Fail(HS_INVALID_ARGUMENT, "boxes",
              "expected minima that are not above the maxima, got %s and "
              "%s on axis %zu of box %zu",
              detail::NumberText(min[wrong]).c_str(),
              detail::NumberText(max[wrong]).c_str(), wrong, begin + i);
  }
}

// Writes row after row of the nearest objects. `values` has the corners.
template <typename Tree>
void Nearest(const Call& call, const Tree& tree, const hs_columns& columns,
             const Values& values, std::size_t k, float max_distance,
             const hs_query_options* options, std::uint32_t* ids,
             float* distances) {
  CheckLength(call, "max_distance", max_distance);
  const SearchOptions search = ReadSearch(call, options);
  if (search.exclusive && tree.layout.kind != PlaneLayout::kAabb) {
    call.Fail(HS_INVALID_ARGUMENT, "options->exclusive",
              "expected 0, as the bounds are not boxes, got 1");
  }
  if (k == 0 || columns.count == 0) return;
  if (columns.count > PTRDIFF_MAX / sizeof(std::uint32_t) / k) {
    call.Fail(HS_INVALID_ARGUMENT, "k",
              "expected rows that fit the address space, got %zu for each "
              "of %zu queries",
              k, columns.count);
  }
  call.CheckArray("ids", ids, columns.count * k);
  if (distances != nullptr) call.CheckPointer("distances", distances);
  ForEachRows(columns, values,
              [&](const float* rows, std::size_t begin, std::size_t count) {
                CheckBoxes(call, rows, begin, count, values.minima);
                const Span<std::uint32_t> its_ids(ids + begin * k, count * k);
                Span<float> its_distances;
                if (distances != nullptr) {
                  its_distances = {distances + begin * k, count * k};
                }
                const detail::NearQueries queries = {rows, values.minima,
                                                     values.count, count};
                tree.core.NearestOfEach(queries, k, max_distance, its_ids,
                                        its_distances, search);
              });
}

template <typename Tree>
hs_status NearestToPoints(const char* name, const Tree* tree,
                          const hs_columns* points, std::size_t k,
                          float max_distance, const hs_query_options* options,
                          std::uint32_t* ids, float* distances) {
  return Run(name, [&](const Call& call) {
    call.CheckPointer(kName<Tree>, tree);
    const std::size_t dims = tree->layout.dims;
    CheckColumns(call, "points", points, 0, dims);
    Nearest(call, *tree, *points, Values::OfPoints(dims), k, max_distance,
            options, ids, distances);
  });
}

template <typename Tree>
hs_status NearestToBoxes(const char* name, const Tree* tree,
                         const hs_columns* boxes, std::size_t k,
                         float max_distance, const hs_query_options* options,
                         std::uint32_t* ids, float* distances) {
  return Run(name, [&](const Call& call) {
    call.CheckPointer(kName<Tree>, tree);
    const Values values = Values::OfBoxes(tree->layout.dims);
    CheckColumns(call, "boxes", boxes, values);
    Nearest(call, *tree, *boxes, values, k, max_distance, options, ids,
            distances);
  });
}

// What is cast: rays have their directions and limits in the same record.
struct Casts {
  enum Kind { kRays, kBoxes, kSpheres };
  Kind kind;
  const hs_columns* starts;
  const hs_columns* motions = nullptr;
  float radius = 0;  // of rays

  const char* name() const {
    return kind == kRays ? "rays" : kind == kBoxes ? "boxes" : "spheres";
  }
};

// Calls hit(cast, id, t) for what each touches: it returns the limit of t from
// then on.
template <typename Tree, typename Hit>
void CastEach(const Call& call, const Tree* tree, const Casts& casts,
              const hs_query_options* options, const Hit& hit) {
  call.CheckPointer(kName<Tree>, tree);
  const std::size_t dims = tree->layout.dims;
  const bool are_rays = casts.kind == Casts::kRays;
  const bool are_spheres = casts.kind == Casts::kSpheres;
  const Values values = are_rays      ? Values::OfColumns(2 * dims + 1)
                        : are_spheres ? Values::OfColumns(dims + 1)
                                      : Values::OfBoxes(dims);
  const Values motion_values = Values::OfColumns(dims + 1);
  CheckColumns(call, casts.name(), casts.starts, values);
  if (casts.kind != Casts::kBoxes) {
    CheckFloats(call, casts.name(), *casts.starts);
  }
  if (are_rays) {
    CheckLength(call, "radius", casts.radius);
  } else {
    CheckColumns(call, "motions", casts.motions, motion_values);
    CheckFloats(call, "motions", *casts.motions);
    if (casts.motions->count != casts.starts->count) {
      call.Fail(HS_INVALID_ARGUMENT, "motions->count",
                "expected one for each of %zu %s, got %zu", casts.starts->count,
                casts.name(), casts.motions->count);
    }
  }
  const SearchOptions search = ReadSearch(call, options);
  ForEachRows(
      *casts.starts, values,
      [&](const float* rows, std::size_t begin, std::size_t count) {
        for (std::size_t i = begin; i < begin + count; ++i) {
          const float* const start = rows + (i - begin) * values.count;
          std::array<float, kMostValues> of_columns;
          const float* motion = start + dims;
          if (!are_rays) {
            WriteRows(*casts.motions, motion_values, i, 1, of_columns.data());
            motion = of_columns.data();
          }
          const float limit = motion[dims];
          CheckNotNegative(call, are_rays ? "rays" : "motions",
                           are_rays ? 2 * dims : dims, "limits of t",
                           are_rays ? "ray" : "motion", i, limit);
          const float radius = are_spheres ? start[dims] : casts.radius;
          CheckNotNegative(call, "spheres", dims, "radii", "sphere", i, radius);
          const float* const high =
              casts.kind == Casts::kBoxes ? start + dims : start;
          detail::Callback one{[&](std::uint32_t id, float t, const float*) {
            return Limit{hit(i, id, t)};
          }};
          const detail::LineCast cast = {
              call.name(), start, high, motion, limit, radius, are_spheres};
          tree->core.Cast(cast, &decltype(one)::Run, &one, search);
        }
      });
}

template <typename Tree>
hs_status Cast(const char* name, const Tree* tree, const Casts& casts,
               const hs_query_options* options, hs_hit_function function,
               void* context) {
  return Run(name, [&](const Call& call) {
    call.CheckPointer("function", function);
    CastEach(call, tree, casts, options,
             [&](std::size_t i, std::uint32_t id, float t) {
               return function(context, i, id, t);
             });
  });
}

// Writes the first hit of each, and of those with the same t the one with the
// least id.
template <typename Tree>
hs_status CastFirst(const char* name, const Tree* tree, const Casts& casts,
                    const hs_query_options* options, std::uint32_t* ids,
                    float* ts) {
  return Run(name, [&](const Call& call) {
    call.CheckPointer(casts.name(), casts.starts);
    const std::size_t count = casts.starts->count;
    call.CheckArray("ids", ids, count);
    std::fill_n(ids, count, HS_NO_ID);
    if (ts != nullptr) {
      call.CheckPointer("ts", ts);
      std::fill_n(ts, count, INFINITY);
    }
    float first_t = INFINITY;
    CastEach(call, tree, casts, options,
             [&](std::size_t i, std::uint32_t id, float t) {
               if (ids[i] == HS_NO_ID || t < first_t ||
                   (t == first_t && id < ids[i])) {
                 ids[i] = id;
                 first_t = t;
                 if (ts != nullptr) ts[i] = t;
               }
               return first_t;
             });
  });
}

}  // namespace

}  // namespace halfspace::c

using halfspace::c::AnyOfEach;
using halfspace::c::Call;
using halfspace::c::Cast;
using halfspace::c::CastFirst;
using halfspace::c::Casts;
using halfspace::c::CountAll;
using halfspace::c::NearestToBoxes;
using halfspace::c::NearestToPoints;
using halfspace::c::Query;
using halfspace::c::QueryEach;

HALFSPACE_DEFAULTS_OF(hs_query_options, kQueryDefaults)

// The searches that BVHs and broad phases have in common. `in` is one of them.
#define HALFSPACE_SEARCHES(Type)                                               \
  hs_status Type##_query(const Type* in, const hs_columns* queries,            \
                         const hs_query_options* options, uint32_t* ids,       \
                         size_t room, size_t* offsets, size_t* total) {        \
    return Query(#Type "_query", in, queries, options, ids, room, offsets,     \
                 total);                                                       \
  }                                                                            \
  hs_status Type##_count(const Type* in, const hs_columns* queries,            \
                         const hs_query_options* options, size_t* counts) {    \
    return CountAll(#Type "_count", in, queries, options, counts);             \
  }                                                                            \
  hs_status Type##_any(const Type* in, const hs_columns* queries,              \
                       const hs_query_options* options, uint32_t* ids) {       \
    return AnyOfEach(#Type "_any", in, queries, options, ids);                 \
  }                                                                            \
  hs_status Type##_query_each(const Type* in, const hs_columns* queries,       \
                              const hs_query_options* options,                 \
                              hs_ids_function function, void* context) {       \
    return QueryEach(#Type "_query_each", in, queries, options, function,      \
                     context);                                                 \
  }                                                                            \
  hs_status Type##_nearest_to_points(                                          \
      const Type* in, const hs_columns* points, size_t k, float max_distance,  \
      const hs_query_options* options, uint32_t* ids, float* distances) {      \
    return NearestToPoints(#Type "_nearest_to_points", in, points, k,          \
                           max_distance, options, ids, distances);             \
  }                                                                            \
  hs_status Type##_nearest_to_boxes(                                           \
      const Type* in, const hs_columns* boxes, size_t k, float max_distance,   \
      const hs_query_options* options, uint32_t* ids, float* distances) {      \
    return NearestToBoxes(#Type "_nearest_to_boxes", in, boxes, k,             \
                          max_distance, options, ids, distances);              \
  }                                                                            \
  hs_status Type##_raycast(const Type* in, const hs_columns* rays,             \
                           float radius, const hs_query_options* options,      \
                           uint32_t* ids, float* ts) {                         \
    return CastFirst(#Type "_raycast", in,                                     \
                     {Casts::kRays, rays, nullptr, radius}, options, ids, ts); \
  }                                                                            \
  hs_status Type##_raycast_each(const Type* in, const hs_columns* rays,        \
                                float radius, const hs_query_options* options, \
                                hs_hit_function function, void* context) {     \
    return Cast(#Type "_raycast_each", in,                                     \
                {Casts::kRays, rays, nullptr, radius}, options, function,      \
                context);                                                      \
  }                                                                            \
  hs_status Type##_boxcast(                                                    \
      const Type* in, const hs_columns* boxes, const hs_columns* motions,      \
      const hs_query_options* options, uint32_t* ids, float* ts) {             \
    return CastFirst(#Type "_boxcast", in, {Casts::kBoxes, boxes, motions},    \
                     options, ids, ts);                                        \
  }                                                                            \
  hs_status Type##_boxcast_each(const Type* in, const hs_columns* boxes,       \
                                const hs_columns* motions,                     \
                                const hs_query_options* options,               \
                                hs_hit_function function, void* context) {     \
    return Cast(#Type "_boxcast_each", in, {Casts::kBoxes, boxes, motions},    \
                options, function, context);                                   \
  }                                                                            \
  hs_status Type##_spherecast(                                                 \
      const Type* in, const hs_columns* spheres, const hs_columns* motions,    \
      const hs_query_options* options, uint32_t* ids, float* ts) {             \
    return CastFirst(#Type "_spherecast", in,                                  \
                     {Casts::kSpheres, spheres, motions}, options, ids, ts);   \
  }                                                                            \
  hs_status Type##_spherecast_each(const Type* in, const hs_columns* spheres,  \
                                   const hs_columns* motions,                  \
                                   const hs_query_options* options,            \
                                   hs_hit_function function, void* context) {  \
    return Cast(#Type "_spherecast_each", in,                                  \
                {Casts::kSpheres, spheres, motions}, options, function,        \
                context);                                                      \
  }

HALFSPACE_SEARCHES(hs_bvh)
HALFSPACE_SEARCHES(hs_broad_phase)
#undef HALFSPACE_SEARCHES

hs_status hs_frustum_planes(const float* matrix, hs_clip_depth depth,
                            hs_matrix_order order, float* half_spaces) {
  return halfspace::c::Run(
      "hs_frustum_planes", [&](const halfspace::c::Call& call) {
        call.CheckArray("matrix", matrix, 16);
        call.CheckArray("half_spaces", half_spaces, 12 * 4);
        const auto check = [&](const char* argument, int value,
                               const char* type) {
          if (value == 0 || value == 1) return;
          call.Fail(HS_INVALID_ARGUMENT, argument,
                    "expected an enumerator of %s, got %d", type, value);
        };
        check("depth", static_cast<int>(depth), "hs_clip_depth");
        check("order", static_cast<int>(order), "hs_matrix_order");
        const halfspace::Frustum3 frustum = halfspace::FrustumPlanes(
            matrix, static_cast<halfspace::ClipDepth>(depth),
            static_cast<halfspace::MatrixOrder>(order));
        for (const halfspace::HalfSpace3& side : frustum) {
          half_spaces =
              std::copy(side.normal.begin(), side.normal.end(), half_spaces);
          *half_spaces++ = side.offset;
        }
      });
}
