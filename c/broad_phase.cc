// hs_broad_phase_...()
#include "halfspace/broad_phase.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "c/bvh.h"
#include "c/call.h"
#include "c/columns.h"

using halfspace::BodyMasks;
using halfspace::Span;
using halfspace::c::AllRows;
using halfspace::c::Call;
using halfspace::c::CheckColumns;
using halfspace::c::Run;
using halfspace::c::Values;
using halfspace::detail::Callback;
namespace detail = halfspace::detail;

// Below the template of broad_phase.h, so that there is one for all kinds.
struct hs_broad_phase {
  hs_broad_phase(const detail::PlaneLayout& its_layout,
                 const hs_broad_phase_config& config,
                 const halfspace::MemoryResource& its_memory);

  const detail::PlaneLayout layout;
  const Values bounds;
  const hs_keep_function keep;
  void* const keep_context;
  const halfspace::MemoryResource memory;
  detail::BroadPhaseCore core;
};

namespace halfspace::c {
namespace {

constexpr hs_broad_phase_config kDefaults = {sizeof(hs_broad_phase_config),
                                             static_cast<hs_kind>(0),
                                             0.0f,
                                             0,
                                             nullptr,
                                             nullptr,
                                             {}};
constexpr hs_update_options kUpdateDefaults = {
    sizeof(hs_update_options), UpdateOptions::kAutomatic, nullptr, nullptr};

static_assert(UpdateOptions::kAutomatic == SIZE_MAX);
static_assert(sizeof(hs_body_masks) == sizeof(BodyMasks));
static_assert(alignof(hs_body_masks) == alignof(BodyMasks));
static_assert(offsetof(hs_body_masks, collides_with) ==
              offsetof(BodyMasks, collides_with));

bool Keep(void* context, std::uint32_t a, std::uint32_t b, bool masks_match) {
  const auto& bodies = *static_cast<const hs_broad_phase*>(context);
  return bodies.keep(bodies.keep_context, a, b, masks_match ? 1 : 0) != 0;
}

BroadPhaseOptions OptionsOf(hs_broad_phase* bodies,
                            const hs_broad_phase_config& config,
                            const MemoryResource& memory) {
  BroadPhaseOptions options;
  options.margin = config.margin;
  if (config.keep != nullptr) options.filter = {&Keep, bodies};
  options.memory = memory;
  return options;
}

Span<const BodyMasks> MasksOf(const Call& call, const hs_body_masks* masks,
                              std::size_t count) {
  call.CheckArray("masks", masks, count);
  return {reinterpret_cast<const BodyMasks*>(masks), count};
}

// An update of all bodies, or with `forced`, a rebuild.
void Update(const Call& call, hs_broad_phase* bodies,
            const hs_update_options* options, bool is_rebuild) {
  call.CheckPointer("bodies", bodies);
  const hs_update_options read =
      ReadOptions(call, "options", options, kUpdateDefaults);
  CallerThreads threads(call, "options->run", read.run, read.run_context);
  if (is_rebuild) {
    bodies->core.Rebuild(threads.runner());
  } else {
    bodies->core.Update({read.budget, threads.runner()});
  }
}

// The columns of queries, or of what moves in casts.
Values ValuesOf(const Call& call, const hs_broad_phase& bodies, hs_shape shape,
                bool is_cast) {
  const std::size_t dims = bodies.layout.dims;
  if (shape == HS_SHAPE_POINT) return Values::OfColumns(dims);
  if (shape == HS_SHAPE_BOUND && !is_cast) return bodies.bounds;
  if (shape == HS_SHAPE_SPHERE) return Values::OfColumns(dims + 1);
  if (shape == HS_SHAPE_BOX && is_cast) {
    return Values::OfBoxes(dims);
  }
  call.Fail(HS_INVALID_ARGUMENT, "shape", "expected %s, got %d",
            is_cast ? "HS_SHAPE_BOX, HS_SHAPE_POINT or HS_SHAPE_SPHERE"
                    : "HS_SHAPE_BOUND, HS_SHAPE_POINT or HS_SHAPE_SPHERE",
            static_cast<int>(shape));
}

void CheckShapes(const Call& call, const char* argument, hs_shape shape,
                 const hs_columns* columns, const Values& values) {
  CheckColumns(call, argument, columns, values);
  if (shape == HS_SHAPE_POINT || shape == HS_SHAPE_SPHERE) {
    CheckFloats(call, argument, *columns);
  }
}

// Null for bounds.
const detail::BvhShapeKind* ShapeKindOf(hs_shape shape, std::size_t dims) {
  if (shape == HS_SHAPE_POINT) {
    return dims == 2 ? &detail::kShapeKind<AabbView2, Point<2>>
                     : &detail::kShapeKind<AabbView3, Point<3>>;
  }
  if (shape == HS_SHAPE_SPHERE) {
    return dims == 2 ? &detail::kShapeKind<AabbView2, Sphere<2>>
                     : &detail::kShapeKind<AabbView3, Sphere<3>>;
  }
  return nullptr;
}

// Calls hit(cast, id, t, bound) for what casts touch: it returns the limit of t
// from then on.
template <typename Hit>
void Cast(const Call& call, const hs_broad_phase* bodies, hs_shape shape,
          const hs_columns* starts, const hs_columns* motions,
          std::uint64_t mask, const Hit& hit) {
  call.CheckPointer("bodies", bodies);
  const std::size_t dims = bodies->layout.dims;
  const Values values = ValuesOf(call, *bodies, shape, /*is_cast=*/true);
  const Values motion_values = Values::OfColumns(dims + 1);
  CheckShapes(call, "starts", shape, starts, values);
  CheckColumns(call, "motions", motions, motion_values);
  CheckFloats(call, "motions", *motions);
  if (motions->count != starts->count) {
    call.Fail(HS_INVALID_ARGUMENT, "motions->count",
              "expected one for each of %zu starts, got %zu", starts->count,
              motions->count);
  }
  const auto cast = [&](std::size_t i, const float* low, const float* motion) {
    CheckNotNegative(call, "motions", dims, "limits of t", "motion", i,
                     motion[dims]);
    const float* const high = shape == HS_SHAPE_BOX ? low + dims : low;
    const float radius = shape == HS_SHAPE_SPHERE ? low[dims] : 0.0f;
    CheckNotNegative(call, "starts", dims, "radii", "sphere", i, radius);
    Callback one{[&](std::uint32_t id, float t, const float* bound) {
      return Limit{hit(i, id, t, bound)};
    }};
    bodies->core.ForEachCast(
        {call.name(), low, high, motion, motion[dims], radius}, mask,
        &decltype(one)::Run, &one);
  };
  const float* const their_motions = RowsInPlace(*motions, motion_values);
  ForEachRows(
      *starts, values,
      [&](const float* rows, std::size_t begin, std::size_t count) {
        for (std::size_t i = 0; i < count; ++i) {
          const float* const start = rows + i * values.count;
          if (their_motions != nullptr) {
            cast(begin + i, start, their_motions + (begin + i) * (dims + 1));
            continue;
          }
          std::array<float, kMostValues> motion;
          WriteRows(*motions, motion_values, begin + i, 1, motion.data());
          cast(begin + i, start, motion.data());
        }
      });
}

// Keeps the first hit of each cast. Of hits with the same t it keeps the one
// with the least id.
struct Closest {
  std::uint32_t* ids;
  float* ts;
  std::size_t last_cast = std::numeric_limits<std::size_t>::max();
  float t = INFINITY;

  float Add(std::size_t cast, std::uint32_t id, float its_t) {
    const bool is_first = cast != last_cast;
    last_cast = cast;
    if (is_first || its_t < t || (its_t == t && id < ids[cast])) {
      ids[cast] = id;
      t = its_t;
      if (ts != nullptr) ts[cast] = t;
    }
    return t;
  }
};

}  // namespace
}  // namespace halfspace::c

hs_broad_phase::hs_broad_phase(const detail::PlaneLayout& its_layout,
                               const hs_broad_phase_config& config,
                               const halfspace::MemoryResource& its_memory)
    : layout(its_layout),
      bounds(Values::OfObjects(its_layout)),
      keep(config.keep),
      keep_context(config.keep_context),
      memory(its_memory),
      core(halfspace::c::TypeOf(its_layout), config.max_ids,
           halfspace::c::OptionsOf(this, config, its_memory)) {}

hs_status hs_broad_phase_config_default(hs_broad_phase_config* config,
                                        size_t struct_size) {
  return halfspace::c::WriteDefaults(
      "hs_broad_phase_config_default", &halfspace::c::kDefaults,
      sizeof(hs_broad_phase_config), config, struct_size);
}

hs_status hs_update_options_default(hs_update_options* options,
                                    size_t struct_size) {
  return halfspace::c::WriteDefaults(
      "hs_update_options_default", &halfspace::c::kUpdateDefaults,
      sizeof(hs_update_options), options, struct_size);
}

hs_status hs_broad_phase_create(const hs_broad_phase_config* config,
                                hs_broad_phase** bodies) {
  return Run("hs_broad_phase_create", [&](const Call& call) {
    call.CheckPointer("bodies", bodies);
    const hs_broad_phase_config read =
        halfspace::c::ReadConfig(call, config, halfspace::c::kDefaults);
    const auto layout = halfspace::c::LayoutOf(call, "config->kind", read.kind);
    if (layout.kind == detail::PlaneLayout::kSimplex) {
      call.Fail(HS_INVALID_ARGUMENT, "config->kind",
                "expected boxes or octahedra, got simplices, "
                "which have no planes that face each other");
    }
    const auto memory = halfspace::c::ReadAllocator(call, read.allocator);
    *bodies = halfspace::c::New<hs_broad_phase>(memory, layout, read, memory);
  });
}

void hs_broad_phase_destroy(hs_broad_phase* bodies) {
  if (bodies != nullptr) halfspace::c::Delete(bodies->memory, bodies);
}

hs_status hs_broad_phase_insert(hs_broad_phase* bodies, const uint32_t* ids,
                                const hs_columns* bounds,
                                const hs_body_masks* masks) {
  return Run("hs_broad_phase_insert", [&](const Call& call) {
    call.CheckPointer("bodies", bodies);
    CheckColumns(call, "bounds", bounds, bodies->bounds);
    const size_t count = bounds->count;
    call.CheckArray("ids", ids, count);
    Span<const BodyMasks> its_masks;
    if (masks != nullptr) its_masks = halfspace::c::MasksOf(call, masks, count);
    const AllRows rows(*bounds, bodies->bounds, bodies->memory);
    bodies->core.Insert({ids, count}, rows.floats(), its_masks);
  });
}

hs_status hs_broad_phase_erase(hs_broad_phase* bodies, const uint32_t* ids,
                               size_t count) {
  return Run("hs_broad_phase_erase", [&](const Call& call) {
    call.CheckPointer("bodies", bodies);
    call.CheckArray("ids", ids, count);
    bodies->core.Erase({ids, count});
  });
}

hs_status hs_broad_phase_move(hs_broad_phase* bodies, const uint32_t* ids,
                              const hs_columns* bounds) {
  return Run("hs_broad_phase_move", [&](const Call& call) {
    call.CheckPointer("bodies", bodies);
    CheckColumns(call, "bounds", bounds, bodies->bounds);
    call.CheckArray("ids", ids, bounds->count);
    const AllRows rows(*bounds, bodies->bounds, bodies->memory);
    bodies->core.Move({ids, bounds->count}, rows.floats());
  });
}

hs_status hs_broad_phase_set_masks(hs_broad_phase* bodies, const uint32_t* ids,
                                   const hs_body_masks* masks, size_t count) {
  return Run("hs_broad_phase_set_masks", [&](const Call& call) {
    call.CheckPointer("bodies", bodies);
    call.CheckArray("ids", ids, count);
    bodies->core.SetMasks({ids, count},
                          halfspace::c::MasksOf(call, masks, count));
  });
}

hs_status hs_broad_phase_update(hs_broad_phase* bodies,
                                const hs_update_options* options) {
  return Run("hs_broad_phase_update", [&](const Call& call) {
    halfspace::c::Update(call, bodies, options, /*is_rebuild=*/false);
  });
}

hs_status hs_broad_phase_rebuild(hs_broad_phase* bodies,
                                 const hs_update_options* options) {
  return Run("hs_broad_phase_rebuild", [&](const Call& call) {
    halfspace::c::Update(call, bodies, options, /*is_rebuild=*/true);
  });
}

hs_status hs_broad_phase_size(const hs_broad_phase* bodies, size_t* size) {
  return Run("hs_broad_phase_size", [&](const Call& call) {
    call.CheckPointer("bodies", bodies);
    call.CheckPointer("size", size);
    *size = bodies->core.size();
  });
}

hs_status hs_broad_phase_has(const hs_broad_phase* bodies, uint32_t id,
                             int* has) {
  return Run("hs_broad_phase_has", [&](const Call& call) {
    call.CheckPointer("bodies", bodies);
    call.CheckPointer("has", has);
    *has = bodies->core.Has(id) ? 1 : 0;
  });
}

hs_status hs_broad_phase_get(const hs_broad_phase* bodies, const uint32_t* ids,
                             size_t count, float* records,
                             hs_body_masks* masks) {
  return Run("hs_broad_phase_get", [&](const Call& call) {
    call.CheckPointer("bodies", bodies);
    call.CheckArray("ids", ids, count);
    if (records != nullptr) call.CheckPointer("records", records);
    if (masks != nullptr) call.CheckPointer("masks", masks);
    const size_t values = bodies->bounds.count;
    for (size_t i = 0; i < count; ++i) {
      if (!bodies->core.Has(ids[i])) {
        call.Fail(HS_INVALID_ARGUMENT, {"ids", "", i},
                  "expected the id of a body, got %u", ids[i]);
      }
      if (records != nullptr) {
        bodies->core.Get(ids[i], {records + i * values, values});
      }
      if (masks != nullptr) {
        const BodyMasks its_masks = bodies->core.MasksOf(ids[i]);
        masks[i] = {its_masks.category, its_masks.collides_with};
      }
    }
  });
}

hs_status hs_broad_phase_bounds(const hs_broad_phase* bodies, float* record) {
  return Run("hs_broad_phase_bounds", [&](const Call& call) {
    call.CheckPointer("bodies", bodies);
    call.CheckPointer("record", record);
    bodies->core.Bounds({record, bodies->bounds.count});
  });
}

hs_status hs_broad_phase_statistics(const hs_broad_phase* bodies,
                                    hs_body_statistics* statistics,
                                    size_t struct_size) {
  constexpr const char* kName = "hs_broad_phase_statistics";
  hs_body_statistics found;
  const hs_status status = Run(kName, [&](const Call& call) {
    call.CheckPointer("bodies", bodies);
    const halfspace::BroadPhaseStatistics its = bodies->core.Statistics();
    found = {sizeof(found), its.bodies, its.pending,   its.pairs,
             its.trees,     its.bytes,  its.cost_ratio};
  });
  if (status != HS_OK) return status;
  return halfspace::c::WriteDefaults(kName, &found, sizeof(found), statistics,
                                     struct_size);
}

hs_status hs_broad_phase_validate(const hs_broad_phase* bodies, int* is_valid) {
  return Run("hs_broad_phase_validate", [&](const Call& call) {
    call.CheckPointer("bodies", bodies);
    call.CheckPointer("is_valid", is_valid);
    *is_valid = bodies->core.Validate() ? 1 : 0;
  });
}

hs_status hs_broad_phase_query(const hs_broad_phase* bodies, hs_shape shape,
                               const hs_columns* queries, uint64_t mask,
                               uint32_t* ids, size_t room, size_t* offsets,
                               size_t* total) {
  return Run("hs_broad_phase_query", [&](const Call& call) {
    call.CheckPointer("bodies", bodies);
    const Values values =
        halfspace::c::ValuesOf(call, *bodies, shape, /*is_cast=*/false);
    halfspace::c::CheckShapes(call, "queries", shape, queries, values);
    call.CheckArray("ids", ids, room);
    call.CheckPointer("total", total);
    if (offsets != nullptr) {
      call.CheckPointer("offsets", offsets);
      offsets[0] = 0;
    }
    const auto* const kind =
        halfspace::c::ShapeKindOf(shape, bodies->layout.dims);
    size_t found = 0;
    Callback body{[&](uint32_t id, const float*) {
      if (found < room) ids[found] = id;
      ++found;
    }};
    halfspace::c::ForEachRows(
        *queries, values, [&](const float* rows, size_t begin, size_t count) {
          for (size_t q = 0; q < count; ++q) {
            bodies->core.ForEach({rows + q * values.count, 1, kind}, mask,
                                 &decltype(body)::Run, &body);
            if (offsets != nullptr) offsets[begin + q + 1] = found;
          }
        });
    *total = found;
  });
}

hs_status hs_broad_phase_for_each(const hs_broad_phase* bodies, hs_shape shape,
                                  const hs_columns* queries, uint64_t mask,
                                  hs_body_function function, void* context) {
  return Run("hs_broad_phase_for_each", [&](const Call& call) {
    call.CheckPointer("bodies", bodies);
    const Values values =
        halfspace::c::ValuesOf(call, *bodies, shape, /*is_cast=*/false);
    halfspace::c::CheckShapes(call, "queries", shape, queries, values);
    call.CheckPointer("function", function);
    const auto* const kind =
        halfspace::c::ShapeKindOf(shape, bodies->layout.dims);
    bool is_stopped = false;
    halfspace::c::ForEachRows(
        *queries, values, [&](const float* rows, size_t begin, size_t count) {
          for (size_t q = 0; q < count && !is_stopped; ++q) {
            Callback body{[&](uint32_t id, const float* bound) {
              is_stopped =
                  function(context, begin + q, id, bound) != HS_CONTINUE;
              return !is_stopped;
            }};
            bodies->core.ForEach({rows + q * values.count, 1, kind}, mask,
                                 &decltype(body)::Run, &body);
          }
        });
  });
}

hs_status hs_broad_phase_for_each_cast(const hs_broad_phase* bodies,
                                       hs_shape shape, const hs_columns* starts,
                                       const hs_columns* motions, uint64_t mask,
                                       hs_body_hit_function function,
                                       void* context) {
  return Run("hs_broad_phase_for_each_cast", [&](const Call& call) {
    call.CheckPointer("function", function);
    halfspace::c::Cast(call, bodies, shape, starts, motions, mask,
                       [&](size_t i, uint32_t id, float t, const float* bound) {
                         return function(context, i, id, t, bound);
                       });
  });
}

hs_status hs_broad_phase_cast(const hs_broad_phase* bodies, hs_shape shape,
                              const hs_columns* starts,
                              const hs_columns* motions, uint64_t mask,
                              uint32_t* ids, float* ts) {
  return Run("hs_broad_phase_cast", [&](const Call& call) {
    call.CheckPointer("starts", starts);
    call.CheckArray("ids", ids, starts->count);
    if (ts != nullptr) call.CheckPointer("ts", ts);
    std::fill_n(ids, starts->count, HS_NO_ID);
    if (ts != nullptr) std::fill_n(ts, starts->count, INFINITY);
    halfspace::c::Closest closest{ids, ts};
    halfspace::c::Cast(call, bodies, shape, starts, motions, mask,
                       [&](size_t i, uint32_t id, float t, const float*) {
                         return closest.Add(i, id, t);
                       });
  });
}

hs_status hs_broad_phase_for_each_pair_of(
    const hs_broad_phase* bodies, const uint32_t* ids, const uint64_t* masks,
    size_t count, float margin, hs_pair_function function, void* context) {
  return Run("hs_broad_phase_for_each_pair_of", [&](const Call& call) {
    call.CheckPointer("bodies", bodies);
    call.CheckArray("ids", ids, count);
    call.CheckPointer("function", function);
    if (masks != nullptr) call.CheckPointer("masks", masks);
    const Span<const uint64_t> its_masks(masks, count);
    Callback pair{[&](uint32_t a, uint32_t b) {
      return function(context, a, b) == HS_CONTINUE;
    }};
    bodies->core.ForEachPairOf(halfspace::c::PairKernelsOf(bodies->layout),
                               {ids, count},
                               masks != nullptr ? &its_masks : nullptr, margin,
                               &decltype(pair)::Run, &pair);
  });
}

hs_status hs_broad_phase_update_pairs(hs_broad_phase* bodies,
                                      const hs_update_options* options,
                                      hs_pair_event began, hs_pair_event ended,
                                      void* context) {
  return Run("hs_broad_phase_update_pairs", [&](const Call& call) {
    call.CheckPointer("bodies", bodies);
    const hs_update_options read = halfspace::c::ReadOptions(
        call, "options", options, halfspace::c::kUpdateDefaults);
    halfspace::c::CallerThreads threads(call, "options->run", read.run,
                                        read.run_context);
    call.CheckPointer("began", began);
    call.CheckPointer("ended", ended);
    bodies->core.UpdatePairs(halfspace::c::PairKernelsOf(bodies->layout),
                             {began, ended, context}, threads.runner());
  });
}
