// hs_bvh_...() that find objects: queries, nearest, rays, pairs.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "c/bvh.h"
#include "c/call.h"
#include "c/columns.h"
#include "halfspace/bvh.h"
#include "halfspace/bvh_nearest.h"
#include "halfspace/bvh_pairs.h"

namespace halfspace::c {
namespace {

constexpr hs_query_options kDefaults = {sizeof(hs_query_options), 0xFFFFFFFF, 0,
                                        nullptr, 0};
constexpr hs_pair_options kPairDefaults = {
    sizeof(hs_pair_options),
    0xFFFFFFFF,
    0.0f,
    0,
    0,
    std::numeric_limits<std::size_t>::max(),
    nullptr};

static_assert(HS_NO_ID == detail::kNoId);
static_assert(sizeof(hs_id_pair) == sizeof(IdPair));
static_assert(alignof(hs_id_pair) == alignof(IdPair));
static_assert(offsetof(hs_id_pair, b) == offsetof(IdPair, b));

// `skip` is an option of hs_bvh_query() alone, and `exclusive` of
// hs_bvh_nearest_...(). The others ignore them.
QueryOptions ReadQuery(const Call& call, const hs_query_options* options,
                       std::size_t* skip = nullptr,
                       bool* is_exclusive = nullptr) {
  if (options == nullptr) return {};
  const hs_query_options read =
      ReadOptions(call, "options", options, kDefaults);
  QueryOptions query;
  query.mask = read.mask;
  query.target = ReadTarget(call, "options", read.target);
  if (skip != nullptr) *skip = read.skip;
  if (is_exclusive != nullptr) *is_exclusive = read.exclusive != 0;
  return query;
}

PairOptions ReadPairs(const Call& call, const hs_pair_options* options) {
  const hs_pair_options read =
      ReadOptions(call, "options", options, kPairDefaults);
  PairOptions pairs;
  pairs.mask = read.mask;
  pairs.margin = read.margin;
  pairs.skip = read.skip;
  pairs.begin = read.begin;
  pairs.end = read.end;
  pairs.target = ReadTarget(call, "options", read.target);
  return pairs;
}

void CheckLength(const Call& call, const char* argument, float length) {
  if (length >= 0) return;
  call.Fail(HS_INVALID_ARGUMENT, argument,
            "expected a number that is not negative, got %s",
            NumberText(length).c_str());
}

SearchOptions ReadSearch(const Call& call, const hs_query_options* options,
                         bool* is_exclusive = nullptr) {
  const QueryOptions query = ReadQuery(call, options, nullptr, is_exclusive);
  return {query.mask, query.target};
}

// Calls the function of hs_bvh_probe().
class Probe {
 public:
  Probe(const hs_bvh* bvh, const QueryOptions& options,
        hs_ids_function function, void* context)
      : bvh_(bvh), options_(options), function_(function), context_(context) {}

  void Run(const float* rows, std::size_t begin, std::size_t count) {
    for (std::size_t q = 0; q < count && !is_stopped_; q += kTogether) {
      const float* const from = rows + q * bvh_->queries.count;
      const std::size_t some = std::min(count - q, kTogether);
      if (is_one_by_one_ || some == 1 || !RunTogether(from, begin + q, some)) {
        RunOneByOne(from, begin + q, some);
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
  bool RunTogether(const float* rows, std::size_t first, std::size_t count) {
    std::array<std::uint32_t, kRoom> ids;
    std::array<std::size_t, kTogether + 1> offsets;
    const std::size_t found = detail::BvhSurvivorsOfEach(
        bvh_->tree, {rows, count}, {ids.data(), ids.size()},
        {offsets.data(), count + 1}, options_, 0);
    is_one_by_one_ = found > ids.size();
    if (is_one_by_one_) return false;
    for (std::size_t q = 0; q < count && !is_stopped_; ++q) {
      if (offsets[q] == offsets[q + 1]) continue;
      Call(first + q, {ids.data() + offsets[q], offsets[q + 1] - offsets[q]});
    }
    return true;
  }

  void RunOneByOne(const float* rows, std::size_t first, std::size_t count) {
    for (std::size_t q = 0; q < count && !is_stopped_; ++q) {
      detail::Callback call{[&](Span<const std::uint32_t> ids) {
        Call(first + q, ids);
        return !is_stopped_;
      }};
      detail::BvhForEach(bvh_->tree, {rows + q * bvh_->queries.count, 1},
                         &decltype(call)::Run, &call, options_);
    }
  }

  void Call(std::size_t query, Span<const std::uint32_t> ids) {
    is_stopped_ =
        function_(context_, query, ids.data(), ids.size()) != HS_CONTINUE;
  }

  const hs_bvh* bvh_;
  const QueryOptions& options_;
  hs_ids_function function_;
  void* context_;
  bool is_one_by_one_ = false;
  bool is_stopped_ = false;
};

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
              NumberText(min[wrong]).c_str(), NumberText(max[wrong]).c_str(),
              wrong, begin + i);
  }
}

// Takes the nearest objects that are not equal to a box.
struct NearestOthers {
  const float* box;
  std::size_t planes;
  std::size_t room;
  std::uint32_t* ids;
  float* distances;

  static float Add(void* others, std::uint32_t id, float distance,
                   const float* planes) {
    auto& its = *static_cast<NearestOthers*>(others);
    std::size_t p = 0;
    while (p < its.planes && planes[p * detail::kBlockObjects] == its.box[p]) {
      ++p;
    }
    if (p == its.planes) return INFINITY;
    *its.ids++ = id;
    if (its.distances != nullptr) *its.distances++ = distance;
    return --its.room == 0 ? -1.0f : INFINITY;
  }
};

// Writes row after row of the nearest objects. `values` has the corners.
void Nearest(const Call& call, const hs_bvh* bvh, const hs_columns& columns,
             const Values& values, std::size_t k, float max_distance,
             const hs_query_options* options, std::uint32_t* ids,
             float* distances) {
  CheckLength(call, "max_distance", max_distance);
  bool is_exclusive = false;
  const SearchOptions search = ReadSearch(call, options, &is_exclusive);
  if (is_exclusive && bvh->layout.kind != PlaneLayout::kAabb) {
    call.Fail(HS_INVALID_ARGUMENT, "options->exclusive",
              "expected 0, as the BVH is not of boxes, got "
              "1");
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
                for (std::size_t q = 0; q < count && is_exclusive; ++q) {
                  const std::size_t row = (begin + q) * k;
                  const float* const box = rows + q * values.count;
                  NearestOthers others{
                      box, values.count, k, ids + row,
                      distances == nullptr ? nullptr : distances + row};
                  std::fill_n(others.ids, k, HS_NO_ID);
                  if (distances != nullptr) {
                    std::fill_n(others.distances, k, INFINITY);
                  }
                  detail::BvhForEachNearest(
                      bvh->tree, {box, values.minima, values.count, 1},
                      max_distance, &NearestOthers::Add, &others, search);
                }
                if (is_exclusive) return;
                detail::BvhNearestOfEach(
                    bvh->tree, {rows, values.minima, values.count, count}, k,
                    max_distance, {ids + begin * k, count * k},
                    distances == nullptr
                        ? Span<float>()
                        : Span<float>(distances + begin * k, count * k),
                    search);
              });
}

// Calls function(ray, id, t) for the objects of each ray. `begin_ray` and
// `end_ray` are called before and after.
template <typename Begin, typename Hit>
void CastRays(const Call& call, const hs_bvh* bvh, const hs_columns* rays,
              float radius, const hs_query_options* options, const Begin& begin,
              Hit& hit) {
  call.CheckPointer("bvh", bvh);
  const std::size_t dims = bvh->layout.dims;
  CheckColumns(call, "rays", rays, 0, 2 * dims + 1);
  CheckFloats(call, "rays", *rays);
  CheckLength(call, "radius", radius);
  const SearchOptions search = ReadSearch(call, options);
  const Values values = Values::OfColumns(2 * dims + 1);
  const auto function = [](void* context, std::uint32_t id, float t,
                           const float*) {
    return (*static_cast<Hit*>(context))(id, t);
  };
  const auto cast = [&](std::size_t i, const float* ray) {
    const float limit = ray[2 * dims];
    CheckNotNegative(call, "rays", 2 * dims, "limits of t", "ray", i, limit);
    begin(i);
    detail::BvhCast(bvh->tree,
                    {call.name(), ray, ray, ray + dims, limit, radius},
                    function, &hit, search);
  };
  ForEachRows(*rays, values,
              [&](const float* rows, std::size_t first, std::size_t count) {
                for (std::size_t i = 0; i < count; ++i) {
                  cast(first + i, rows + i * values.count);
                }
              });
}

detail::PairSources SourcesOf(const Call& call, const hs_bvh* a,
                              const hs_bvh* b) {
  if (a->layout.kind == PlaneLayout::kSimplex) {
    call.Fail(HS_INVALID_ARGUMENT, "",
              "expected BVHs of boxes or octahedra, got simplices, which have "
              "no planes that face each other");
  }
  if (b != nullptr && b->layout != a->layout) {
    call.Fail(HS_INVALID_ARGUMENT, "b",
              "expected a BVH of the kind of `a`, got another kind");
  }
  return {PairKernelsOf(a->layout), &a->tree, b == nullptr ? nullptr : &b->tree,
          nullptr};
}

void WritePairs(const Call& call, const hs_bvh* a, const hs_bvh* b,
                const hs_pair_options* options, hs_id_pair* pairs,
                std::size_t room, std::size_t* total) {
  call.CheckArray("pairs", pairs, room);
  call.CheckPointer("total", total);
  *total = detail::BvhPairs(SourcesOf(call, a, b),
                            {reinterpret_cast<IdPair*>(pairs), room},
                            ReadPairs(call, options));
}

void CallForPairs(const Call& call, const hs_bvh* a, const hs_bvh* b,
                  const hs_pair_options* options, hs_pairs_function function,
                  void* context) {
  call.CheckPointer("function", function);
  const auto some = [&](Span<const IdPair> pairs) {
    return function(context, reinterpret_cast<const hs_id_pair*>(pairs.data()),
                    pairs.size()) == HS_CONTINUE;
  };
  using Some = decltype(some);
  detail::BvhForEachPair(
      SourcesOf(call, a, b),
      [](void* of_call, Span<const IdPair> pairs) {
        return (*static_cast<Some*>(of_call))(pairs);
      },
      const_cast<void*>(static_cast<const void*>(&some)),
      ReadPairs(call, options));
}

}  // namespace

const detail::BvhPairKernels* PairKernelsOf(const PlaneLayout& layout) {
  if (layout.axes == 2) return detail::BvhPairKernelsOf<2>::kTargets;
  if (layout.axes == 3) return detail::BvhPairKernelsOf<3>::kTargets;
  return detail::BvhPairKernelsOf<4>::kTargets;
}

}  // namespace halfspace::c

using halfspace::QueryOptions;
using halfspace::c::Call;
using halfspace::c::CheckColumns;
using halfspace::c::ForEachRows;
using halfspace::c::ReadQuery;
using halfspace::c::Results;
using halfspace::c::Run;
namespace detail = halfspace::detail;

hs_status hs_query_options_default(hs_query_options* options,
                                   size_t struct_size) {
  return halfspace::c::WriteDefaults(
      "hs_query_options_default", &halfspace::c::kDefaults,
      sizeof(hs_query_options), options, struct_size);
}

hs_status hs_pair_options_default(hs_pair_options* options,
                                  size_t struct_size) {
  return halfspace::c::WriteDefaults(
      "hs_pair_options_default", &halfspace::c::kPairDefaults,
      sizeof(hs_pair_options), options, struct_size);
}

hs_status hs_bvh_query(const hs_bvh* bvh, const hs_columns* queries,
                       const hs_query_options* options, uint32_t* ids,
                       size_t room, size_t* offsets, size_t* total) {
  return Run("hs_bvh_query", [&](const Call& call) {
    call.CheckPointer("bvh", bvh);
    CheckColumns(call, "queries", queries, bvh->queries);
    size_t skip = 0;
    const QueryOptions query = ReadQuery(call, options, &skip);
    call.CheckArray("ids", ids, room);
    call.CheckPointer("total", total);
    size_t own_offsets[halfspace::c::kMostRows + 1];
    if (offsets != nullptr) {
      call.CheckPointer("offsets", offsets);
      offsets[0] = 0;
    }
    Results<uint32_t> results(ids, room, skip);
    ForEachRows(
        *queries, bvh->queries,
        [&](const float* rows, size_t begin, size_t count) {
          if (count == 1) {
            results.Add(detail::BvhSurvivors(
                bvh->tree, {rows, 1}, results.span(), query, results.skip()));
            if (offsets != nullptr) offsets[begin + 1] = results.total();
            return;
          }
          size_t* const to = offsets != nullptr ? offsets + begin : own_offsets;
          const size_t before = results.total();
          results.Add(detail::BvhSurvivorsOfEach(
              bvh->tree, {rows, count}, results.span(), {to, count + 1}, query,
              results.skip()));
          for (size_t i = 0; i <= count; ++i) to[i] += before;
        });
    *total = results.total();
  });
}

hs_status hs_bvh_count(const hs_bvh* bvh, const hs_columns* queries,
                       const hs_query_options* options, size_t* counts) {
  return Run("hs_bvh_count", [&](const Call& call) {
    call.CheckPointer("bvh", bvh);
    CheckColumns(call, "queries", queries, bvh->queries);
    const QueryOptions query = ReadQuery(call, options);
    call.CheckArray("counts", counts, queries->count);
    ForEachRows(*queries, bvh->queries,
                [&](const float* rows, size_t begin, size_t count) {
                  detail::BvhCountOfEach(bvh->tree, {rows, count},
                                         {counts + begin, count}, query);
                });
  });
}

hs_status hs_bvh_any(const hs_bvh* bvh, const hs_columns* queries,
                     const hs_query_options* options, uint32_t* ids) {
  return Run("hs_bvh_any", [&](const Call& call) {
    call.CheckPointer("bvh", bvh);
    CheckColumns(call, "queries", queries, bvh->queries);
    const QueryOptions query = ReadQuery(call, options);
    call.CheckArray("ids", ids, queries->count);
    ForEachRows(*queries, bvh->queries,
                [&](const float* rows, size_t begin, size_t count) {
                  for (size_t q = 0; q < count; ++q) {
                    uint32_t id = HS_NO_ID;
                    const bool has_one = detail::BvhAny(
                        bvh->tree, {rows + q * bvh->queries.count, 1}, id,
                        query);
                    ids[begin + q] = has_one ? id : HS_NO_ID;
                  }
                });
  });
}

hs_status hs_bvh_probe(const hs_bvh* bvh, const hs_columns* queries,
                       const hs_query_options* options,
                       hs_ids_function function, void* context) {
  return Run("hs_bvh_probe", [&](const Call& call) {
    call.CheckPointer("bvh", bvh);
    CheckColumns(call, "queries", queries, bvh->queries);
    const QueryOptions query = ReadQuery(call, options);
    call.CheckPointer("function", function);
    halfspace::c::Probe probe{bvh, query, function, context};
    ForEachRows(*queries, bvh->queries,
                [&](const float* rows, size_t begin, size_t count) {
                  probe.Run(rows, begin, count);
                });
  });
}

hs_status hs_bvh_nearest_to_points(const hs_bvh* bvh, const hs_columns* points,
                                   size_t k, float max_distance,
                                   const hs_query_options* options,
                                   uint32_t* ids, float* distances) {
  return Run("hs_bvh_nearest_to_points", [&](const Call& call) {
    call.CheckPointer("bvh", bvh);
    const size_t dims = bvh->layout.dims;
    CheckColumns(call, "points", points, 0, dims);
    halfspace::c::Nearest(call, bvh, *points,
                          halfspace::c::Values::OfPoints(dims), k, max_distance,
                          options, ids, distances);
  });
}

hs_status hs_bvh_nearest_to_boxes(const hs_bvh* bvh, const hs_columns* boxes,
                                  size_t k, float max_distance,
                                  const hs_query_options* options,
                                  uint32_t* ids, float* distances) {
  return Run("hs_bvh_nearest_to_boxes", [&](const Call& call) {
    call.CheckPointer("bvh", bvh);
    const size_t dims = bvh->layout.dims;
    const auto values = halfspace::c::Values::OfBoxes(dims);
    CheckColumns(call, "boxes", boxes, values);
    halfspace::c::Nearest(call, bvh, *boxes, values, k, max_distance, options,
                          ids, distances);
  });
}

hs_status hs_bvh_raycast(const hs_bvh* bvh, const hs_columns* rays,
                         float radius, const hs_query_options* options,
                         uint32_t* ids, float* ts) {
  return Run("hs_bvh_raycast", [&](const Call& call) {
    call.CheckPointer("rays", rays);
    call.CheckArray("ids", ids, rays->count);
    if (ts != nullptr) call.CheckPointer("ts", ts);
    uint32_t* closest = nullptr;
    float own_t = 0;
    float* closest_t = &own_t;
    const auto begin = [&](size_t ray) {
      closest = ids + ray;
      *closest = HS_NO_ID;
      if (ts != nullptr) closest_t = ts + ray;
      *closest_t = INFINITY;
    };
    auto hit = [&](uint32_t id, float t) {
      if (t < *closest_t || (t == *closest_t && id < *closest)) {
        *closest = id;
        *closest_t = t;
      }
      return *closest_t;
    };
    halfspace::c::CastRays(call, bvh, rays, radius, options, begin, hit);
  });
}

hs_status hs_bvh_raycast_each(const hs_bvh* bvh, const hs_columns* rays,
                              float radius, const hs_query_options* options,
                              hs_hit_function function, void* context) {
  return Run("hs_bvh_raycast_each", [&](const Call& call) {
    call.CheckPointer("function", function);
    size_t ray = 0;
    const auto begin = [&](size_t i) { ray = i; };
    auto hit = [&](uint32_t id, float t) {
      return function(context, ray, id, t);
    };
    halfspace::c::CastRays(call, bvh, rays, radius, options, begin, hit);
  });
}

hs_status hs_bvh_pairs(const hs_bvh* bvh, const hs_pair_options* options,
                       hs_id_pair* pairs, size_t room, size_t* total) {
  return Run("hs_bvh_pairs", [&](const Call& call) {
    call.CheckPointer("bvh", bvh);
    halfspace::c::WritePairs(call, bvh, nullptr, options, pairs, room, total);
  });
}

hs_status hs_bvh_join(const hs_bvh* a, const hs_bvh* b,
                      const hs_pair_options* options, hs_id_pair* pairs,
                      size_t room, size_t* total) {
  return Run("hs_bvh_join", [&](const Call& call) {
    call.CheckPointer("a", a);
    call.CheckPointer("b", b);
    halfspace::c::WritePairs(call, a, b, options, pairs, room, total);
  });
}

hs_status hs_bvh_pairs_each(const hs_bvh* bvh, const hs_pair_options* options,
                            hs_pairs_function function, void* context) {
  return Run("hs_bvh_pairs_each", [&](const Call& call) {
    call.CheckPointer("bvh", bvh);
    halfspace::c::CallForPairs(call, bvh, nullptr, options, function, context);
  });
}

hs_status hs_bvh_join_each(const hs_bvh* a, const hs_bvh* b,
                           const hs_pair_options* options,
                           hs_pairs_function function, void* context) {
  return Run("hs_bvh_join_each", [&](const Call& call) {
    call.CheckPointer("a", a);
    call.CheckPointer("b", b);
    halfspace::c::CallForPairs(call, a, b, options, function, context);
  });
}

hs_status hs_bvh_pair_parts(const hs_bvh* bvh, size_t* parts) {
  return Run("hs_bvh_pair_parts", [&](const Call& call) {
    call.CheckPointer("bvh", bvh);
    call.CheckPointer("parts", parts);
    *parts = (bvh->tree.ids().size() + 63) / 64;
  });
}
