// hs_broad_phase_...() that create and change broad phases. The searches are in
// queries.cc.
#include "c/broad_phase.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "c/bvh.h"
#include "c/call.h"
#include "c/columns.h"
#include "halfspace/error.h"

using halfspace::BodyMasks;
using halfspace::Span;
using halfspace::c::AllRows;
using halfspace::c::Call;
using halfspace::c::CheckColumns;
using halfspace::c::Get;
using halfspace::c::Run;
namespace detail = halfspace::detail;

namespace halfspace::c {
namespace {

constexpr hs_broad_phase_config kBroadPhaseDefaults = {
    sizeof(hs_broad_phase_config),
    static_cast<hs_kind>(0),
    0,
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

Span<const BodyMasks> MasksOf(const Call& call, const hs_body_masks* masks,
                              std::size_t count) {
  call.CheckArray("masks", masks, count);
  return {reinterpret_cast<const BodyMasks*>(masks), count};
}

// Calls update(call, budget, runner).
template <typename Function>
hs_status RunUpdate(const char* name, hs_broad_phase* bodies,
                    const hs_update_options* options, const Function& update) {
  return Run(name, [&](const Call& call) {
    call.CheckPointer("bodies", bodies);
    const hs_update_options read =
        ReadOptions(call, "options", options, kUpdateDefaults);
    CallerThreads threads(call, "options->run", read.run, read.run_context);
    update(call, read.budget, threads.runner());
  });
}

// The pieces of saved bytes, one after another, as far as there is room.
struct SavedBytes {
  std::byte* to;
  std::size_t room;
  std::size_t size = 0;

  static void Add(void* bytes, Span<const std::byte> piece) {
    auto& its = *static_cast<SavedBytes*>(bytes);
    const std::size_t begin = std::min(its.room, its.size);
    std::copy_n(piece.data(), std::min(its.room - begin, piece.size()),
                its.to + begin);
    its.size += piece.size();
  }
};

}  // namespace
}  // namespace halfspace::c

hs_broad_phase::hs_broad_phase(const detail::PlaneLayout& its_layout,
                               const halfspace::BroadPhaseOptions& options)
    : layout(its_layout),
      objects(halfspace::c::Values::OfObjects(its_layout)),
      memory(options.memory),
      core(halfspace::c::TypeOf(its_layout), options) {}

HALFSPACE_DEFAULTS_OF(hs_broad_phase_config, kBroadPhaseDefaults)
HALFSPACE_DEFAULTS_OF(hs_update_options, kUpdateDefaults)

hs_status hs_broad_phase_create(const hs_broad_phase_config* config,
                                hs_broad_phase** bodies) {
  return Run("hs_broad_phase_create", [&](const Call& call) {
    call.CheckPointer("bodies", bodies);
    const hs_broad_phase_config read = halfspace::c::ReadConfig(
        call, config, halfspace::c::kBroadPhaseDefaults);
    const auto layout = halfspace::c::LayoutOf(call, "config->kind", read.kind);
    if (layout.kind == detail::PlaneLayout::kSimplex) {
      call.Fail(HS_INVALID_ARGUMENT, "config->kind",
                "expected boxes or octahedra, got simplices, "
                "which have no planes that face each other");
    }
    halfspace::BroadPhaseOptions options;
    options.filter = {read.keep, read.keep_context};
    options.memory = halfspace::c::ReadAllocator(call, read.allocator);
    options.moves_are_seen_at_once = read.moves_are_seen_at_once != 0;
    options.caller_locks = read.caller_locks != 0;
    *bodies =
        halfspace::c::New<hs_broad_phase>(options.memory, layout, options);
  });
}

hs_status hs_broad_phase_copy(const hs_broad_phase* bodies,
                              hs_broad_phase** copy) {
  return Get("hs_broad_phase_copy", "bodies", bodies, "copy", copy, [&] {
    return halfspace::c::New<hs_broad_phase>(bodies->memory, *bodies);
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
    CheckColumns(call, "bounds", bounds, bodies->objects);
    const size_t count = bounds->count;
    call.CheckArray("ids", ids, count);
    Span<const BodyMasks> its_masks;
    if (masks != nullptr) its_masks = halfspace::c::MasksOf(call, masks, count);
    const AllRows rows(*bounds, bodies->objects, bodies->memory);
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
    CheckColumns(call, "bounds", bounds, bodies->objects);
    call.CheckArray("ids", ids, bounds->count);
    const AllRows rows(*bounds, bodies->objects, bodies->memory);
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
  return halfspace::c::RunUpdate(
      "hs_broad_phase_update", bodies, options,
      [&](const Call&, size_t budget, const halfspace::Runner& run) {
        bodies->core.Update({budget, run});
      });
}

hs_status hs_broad_phase_rebuild(hs_broad_phase* bodies,
                                 const hs_update_options* options) {
  return halfspace::c::RunUpdate(
      "hs_broad_phase_rebuild", bodies, options,
      [&](const Call&, size_t, const halfspace::Runner& run) {
        bodies->core.Rebuild(run);
      });
}

hs_status hs_broad_phase_update_pairs(hs_broad_phase* bodies,
                                      const hs_update_options* options) {
  return halfspace::c::RunUpdate(
      "hs_broad_phase_update_pairs", bodies, options,
      [&](const Call& call, size_t, const halfspace::Runner& run) {
        bodies->core.UpdatePairs(
            halfspace::c::PairKernelsOf(call, bodies->layout), run);
      });
}

hs_status hs_broad_phase_pairs(const hs_broad_phase* bodies,
                               const hs_id_pair** pairs, size_t* count) {
  return halfspace::c::ListPairs("hs_broad_phase_pairs", "bodies", bodies,
                                 &detail::PairEventsCore::pairs, pairs, count);
}

hs_status hs_broad_phase_began(const hs_broad_phase* bodies,
                               const hs_id_pair** pairs, size_t* count) {
  return halfspace::c::ListPairs("hs_broad_phase_began", "bodies", bodies,
                                 &detail::PairEventsCore::began, pairs, count);
}

hs_status hs_broad_phase_ended(const hs_broad_phase* bodies,
                               const hs_id_pair** pairs, size_t* count) {
  return halfspace::c::ListPairs("hs_broad_phase_ended", "bodies", bodies,
                                 &detail::PairEventsCore::ended, pairs, count);
}

hs_status hs_broad_phase_size(const hs_broad_phase* bodies, size_t* size) {
  return Get("hs_broad_phase_size", "bodies", bodies, "size", size,
             [&] { return bodies->core.size(); });
}

hs_status hs_broad_phase_id_limit(const hs_broad_phase* bodies, size_t* limit) {
  return Get("hs_broad_phase_id_limit", "bodies", bodies, "limit", limit,
             [&] { return bodies->core.id_limit(); });
}

hs_status hs_broad_phase_has(const hs_broad_phase* bodies, uint32_t id,
                             int* has) {
  return Get("hs_broad_phase_has", "bodies", bodies, "has", has,
             [&] { return bodies->core.Has(id) ? 1 : 0; });
}

hs_status hs_broad_phase_get(const hs_broad_phase* bodies, const uint32_t* ids,
                             size_t count, float* records,
                             hs_body_masks* masks) {
  return Run("hs_broad_phase_get", [&](const Call& call) {
    call.CheckPointer("bodies", bodies);
    call.CheckArray("ids", ids, count);
    if (records != nullptr) call.CheckPointer("records", records);
    if (masks != nullptr) call.CheckPointer("masks", masks);
    const size_t values = bodies->objects.count;
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
    bodies->core.Bounds({record, bodies->objects.count});
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
    found = {sizeof(found), its.bodies, its.pairs, its.bytes, its.cost_ratio};
  });
  if (status != HS_OK) return status;
  return halfspace::c::WriteDefaults(kName, &found, sizeof(found), statistics,
                                     struct_size);
}

hs_status hs_broad_phase_validate(const hs_broad_phase* bodies, int* is_valid) {
  return Get("hs_broad_phase_validate", "bodies", bodies, "is_valid", is_valid,
             [&] { return bodies->core.Validate() ? 1 : 0; });
}

hs_status hs_broad_phase_save(const hs_broad_phase* bodies, void* data,
                              size_t room, size_t* size) {
  return Run("hs_broad_phase_save", [&](const Call& call) {
    call.CheckPointer("bodies", bodies);
    auto* const to = static_cast<std::byte*>(data);
    call.CheckArray("data", to, room);
    call.CheckPointer("size", size);
    halfspace::c::SavedBytes bytes{to, room};
    bodies->core.Save(&halfspace::c::SavedBytes::Add, &bytes);
    *size = bytes.size;
  });
}

hs_status hs_broad_phase_load(hs_broad_phase* bodies, const void* data,
                              size_t size) {
  return Run("hs_broad_phase_load", [&](const Call& call) {
    call.CheckPointer("bodies", bodies);
    const auto* const bytes = static_cast<const std::byte*>(data);
    call.CheckArray("data", bytes, size);
    try {
      bodies->core.Load({bytes, size});
    } catch (const halfspace::Error& error) {
      // A mistake of the caller's is not in the bytes.
      const std::string_view argument = error.argument();
      const bool is_in_bytes =
          argument == "bytes" || argument == "blob" || argument == "pairs";
      if (!is_in_bytes) throw;
      call.Fail(HS_CORRUPT, error, "data");
    }
  });
}
