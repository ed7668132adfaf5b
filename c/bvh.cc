// hs_bvh_...() that create and change a hierarchy.
#include "c/bvh.h"

#include <array>
#include <atomic>
#include <cmath>
#include <exception>
#include <optional>

using halfspace::c::BvhConfig;
using halfspace::c::Call;
using halfspace::c::CheckColumns;
using halfspace::c::ColumnsOf;
using halfspace::c::Get;
using halfspace::c::Run;
using halfspace::c::Values;
using halfspace::detail::PlaneLayout;

namespace halfspace::c {
namespace {

constexpr hs_bvh_config kBvhDefaults = {sizeof(hs_bvh_config),
                                        static_cast<hs_kind>(0),
                                        HS_QUALITY_HIGH,
                                        nullptr,
                                        nullptr,
                                        nullptr,
                                        {},
                                        nullptr};

// What the part functions of one call of `run` share. They can run at the same
// time, and must not throw through the caller's function.
struct Parts {
  Parts(const Runner::Part& its_part, std::size_t its_count)
      : part(its_part), count(its_count) {}

  const Runner::Part& part;
  const std::size_t count;
  std::atomic<std::size_t> next{0};
  std::atomic<std::size_t> done{0};
  std::atomic_flag has_failed;
  std::exception_ptr error;

  // The index of the caller could be wrong: a part would run twice, and another
  // one never. So each call takes the next part.
  static void RunPart(void* work, std::size_t) noexcept {
    auto& parts = *static_cast<Parts*>(work);
    const std::size_t i = parts.next.fetch_add(1);
    try {
      if (i < parts.count) parts.part(i);
    } catch (...) {
      if (!parts.has_failed.test_and_set()) {
        parts.error = std::current_exception();
      }
    }
    parts.done.fetch_add(1);
  }
};

BuildQuality ReadQuality(const Call& call, hs_quality quality) {
  if (quality == HS_QUALITY_HIGH) return BuildQuality::kHigh;
  if (quality == HS_QUALITY_FAST) return BuildQuality::kFast;
  call.Fail(HS_INVALID_ARGUMENT, "config->quality",
            "expected an enumerator of hs_quality, got %d",
            static_cast<int>(quality));
}

std::optional<std::array<float, 3>> ReadExtents(const Call& call,
                                                const char* argument,
                                                const PlaneLayout& layout,
                                                const float* extents) {
  if (extents == nullptr) return std::nullopt;
  call.CheckArray(argument, extents, layout.dims);
  std::array<float, 3> read{};
  for (std::size_t k = 0; k < layout.dims; ++k) {
    read[k] = extents[k];
    // Compares that never trap.
    if (!std::isnan(read[k]) && (!std::signbit(read[k]) || read[k] == 0)) {
      continue;
    }
    call.Fail(HS_INVALID_ARGUMENT, argument,
              "expected numbers that are not negative, got %s on axis %zu",
              detail::NumberText(read[k]).c_str(), k);
  }
  return read;
}

// Minima of simplices become a record with maxima.
void WriteRecord(const hs_bvh& bvh, const float* values, float* record) {
  for (std::size_t v = 0; v < RecordValues(bvh.layout); ++v) {
    record[v] = v < bvh.objects.count ? values[v] : INFINITY;
  }
}

}  // namespace

detail::BvhType TypeOf(const PlaneLayout& layout) {
  return WithView(layout, []<typename View>(const View&) {
    return detail::BvhTypeOf<View>();
  });
}

BvhConfig::BvhConfig(const Call& call, const hs_bvh_config* config) {
  const hs_bvh_config read = ReadConfig(call, config, kBvhDefaults);
  layout = LayoutOf(call, "config->kind", read.kind);
  run = read.run;
  run_context = read.run_context;
  options.quality = ReadQuality(call, read.quality);
  options.target = ReadTarget(call, "config", read.target);
  options.memory = ReadAllocator(call, read.allocator);
  options.query_extents =
      ReadExtents(call, "config->query_extents", layout, read.query_extents);
}

NewBvh BuildBvh(const Call& call, const BvhConfig& config,
                const detail::Columns& objects) {
  CallerThreads threads(call, "config->run", config.run, config.run_context);
  BuildOptions options = config.options;
  options.run = threads.runner();
  auto bvh = MakeBvh(config.layout, options.memory);
  bvh->core.Build(objects, options);
  return bvh;
}

void CallerThreads::operator()(std::size_t count,
                               const Runner::Part& part) const {
  Parts parts(part, count);
  run_(context_, count, &Parts::RunPart, &parts);
  if (parts.error != nullptr) std::rethrow_exception(parts.error);
  if (const std::size_t done = parts.done.load(); done != count) {
    call_.Fail(HS_INVALID_ARGUMENT, argument_,
               "expected %zu calls of `part`, got %zu", count, done);
  }
}

}  // namespace halfspace::c

hs_bvh::hs_bvh(const PlaneLayout& its_layout,
               const halfspace::MemoryResource& memory)
    : layout(its_layout),
      objects(Values::OfObjects(layout)),
      queries(Values::OfQueries(layout)),
      core(halfspace::c::TypeOf(layout), memory) {}

HALFSPACE_DEFAULTS_OF(hs_bvh_config, kBvhDefaults)

hs_status hs_bvh_create(const hs_bvh_config* config, const hs_columns* objects,
                        hs_bvh** bvh) {
  return Run("hs_bvh_create", [&](const Call& call) {
    call.CheckPointer("bvh", bvh);
    const BvhConfig read(call, config);
    const Values values = Values::OfObjects(read.layout);
    CheckColumns(call, "objects", objects, values);
    *bvh = halfspace::c::BuildBvh(call, read, ColumnsOf(*objects, values))
               .release();
  });
}

void hs_bvh_destroy(hs_bvh* bvh) {
  if (bvh != nullptr) halfspace::c::Delete(bvh->core.memory(), bvh);
}

hs_status hs_bvh_size(const hs_bvh* bvh, size_t* size) {
  return Get("hs_bvh_size", "bvh", bvh, "size", size,
             [&] { return bvh->core.size(); });
}

hs_status hs_bvh_id_limit(const hs_bvh* bvh, size_t* limit) {
  return Get("hs_bvh_id_limit", "bvh", bvh, "limit", limit,
             [&] { return bvh->core.id_limit(); });
}

hs_status hs_bvh_bounds(const hs_bvh* bvh, float* record) {
  return Run("hs_bvh_bounds", [&](const Call& call) {
    call.CheckPointer("bvh", bvh);
    call.CheckPointer("record", record);
    std::array<float, halfspace::c::kMostValues> values;
    bvh->core.Bounds({values.data(), bvh->objects.count});
    halfspace::c::WriteRecord(*bvh, values.data(), record);
  });
}

hs_status hs_bvh_get(const hs_bvh* bvh, const uint32_t* ids, size_t count,
                     float* records) {
  return Run("hs_bvh_get", [&](const Call& call) {
    call.CheckPointer("bvh", bvh);
    call.CheckArray("ids", ids, count);
    call.CheckArray("records", records, count);
    bvh->core.CheckIds({ids, count}, call.name());
    std::array<float, halfspace::c::kMostValues> values;
    for (size_t i = 0; i < count; ++i) {
      bvh->core.Get(ids[i], {values.data(), bvh->objects.count});
      halfspace::c::WriteRecord(
          *bvh, values.data(),
          records + i * halfspace::c::RecordValues(bvh->layout));
    }
  });
}

hs_status hs_bvh_get_all(const hs_bvh* bvh, float* records, size_t room) {
  return Run("hs_bvh_get_all", [&](const Call& call) {
    call.CheckPointer("bvh", bvh);
    const halfspace::detail::BvhTree& tree = bvh->core;
    const size_t limit = tree.id_limit();
    if (room < limit) {
      call.Fail(HS_INVALID_ARGUMENT, "room",
                "expected at least hs_bvh_id_limit(), %zu, got %zu", limit,
                room);
    }
    call.CheckArray("records", records, limit);
    const size_t values = halfspace::c::RecordValues(bvh->layout);
    for (size_t i = 0; i < limit * values; ++i) {
      records[i] = i % values < bvh->layout.axes ? INFINITY : -INFINITY;
    }
    const auto ids = tree.ids();
    std::array<float, halfspace::c::kMostValues> its_values;
    for (size_t slot = 0; slot < ids.size(); ++slot) {
      // An empty slot, or an altered blob.
      if (ids[slot] >= limit) continue;
      tree.GetAt(slot, {its_values.data(), bvh->objects.count});
      halfspace::c::WriteRecord(*bvh, its_values.data(),
                                records + ids[slot] * values);
    }
  });
}

hs_status hs_bvh_bytes(const hs_bvh* bvh, size_t* bytes) {
  return Get("hs_bvh_bytes", "bvh", bvh, "bytes", bytes,
             [&] { return bvh->core.bytes(); });
}

hs_status hs_bvh_insert(hs_bvh* bvh, const hs_columns* objects, uint32_t* ids) {
  return Run("hs_bvh_insert", [&](const Call& call) {
    call.CheckPointer("bvh", bvh);
    CheckColumns(call, "objects", objects, bvh->objects);
    call.CheckArray("ids", ids, objects->count);
    bvh->core.Insert(ColumnsOf(*objects, bvh->objects), {ids, objects->count});
  });
}

hs_status hs_bvh_insert_as(hs_bvh* bvh, const uint32_t* ids,
                           const hs_columns* objects) {
  return Run("hs_bvh_insert_as", [&](const Call& call) {
    call.CheckPointer("bvh", bvh);
    CheckColumns(call, "objects", objects, bvh->objects);
    call.CheckArray("ids", ids, objects->count);
    bvh->core.InsertAs({ids, objects->count},
                       ColumnsOf(*objects, bvh->objects));
  });
}

hs_status hs_bvh_reserve(hs_bvh* bvh, size_t objects) {
  return Run("hs_bvh_reserve", [&](const Call& call) {
    call.CheckPointer("bvh", bvh);
    bvh->core.Reserve(objects);
  });
}

hs_status hs_bvh_set(hs_bvh* bvh, const uint32_t* ids,
                     const hs_columns* objects) {
  return Run("hs_bvh_set", [&](const Call& call) {
    call.CheckPointer("bvh", bvh);
    CheckColumns(call, "objects", objects, bvh->objects);
    call.CheckArray("ids", ids, objects->count);
    bvh->core.Set({ids, objects->count}, ColumnsOf(*objects, bvh->objects));
  });
}

hs_status hs_bvh_erase(hs_bvh* bvh, const uint32_t* ids, size_t count) {
  return Run("hs_bvh_erase", [&](const Call& call) {
    call.CheckPointer("bvh", bvh);
    call.CheckArray("ids", ids, count);
    bvh->core.Erase({ids, count});
  });
}

hs_status hs_bvh_set_masks(hs_bvh* bvh, const uint32_t* ids,
                           const uint32_t* masks, size_t count) {
  return Run("hs_bvh_set_masks", [&](const Call& call) {
    call.CheckPointer("bvh", bvh);
    call.CheckArray("ids", ids, count);
    call.CheckArray("masks", masks, count);
    bvh->core.CheckIds({ids, count}, call.name());
    // Only the first allocates.
    for (size_t i = 0; i < count; ++i) bvh->core.SetMasks(ids[i], masks[i]);
  });
}

hs_status hs_bvh_set_all_masks(hs_bvh* bvh, const uint32_t* masks,
                               size_t count) {
  return Run("hs_bvh_set_all_masks", [&](const Call& call) {
    call.CheckPointer("bvh", bvh);
    call.CheckArray("masks", masks, count);
    bvh->core.SetMasks({masks, count});
  });
}

hs_status hs_bvh_refit(hs_bvh* bvh, const hs_columns* objects,
                       hs_run_function run, void* run_context) {
  return Run("hs_bvh_refit", [&](const Call& call) {
    call.CheckPointer("bvh", bvh);
    CheckColumns(call, "objects", objects, bvh->objects);
    halfspace::c::CallerThreads threads(call, "run", run, run_context);
    bvh->core.Refit(ColumnsOf(*objects, bvh->objects), true, threads.runner());
  });
}

hs_status hs_bvh_rebuild(hs_bvh* bvh, const hs_bvh_config* config) {
  return Run("hs_bvh_rebuild", [&](const Call& call) {
    call.CheckPointer("bvh", bvh);
    const hs_bvh_config read = halfspace::c::ReadOptions(
        call, "config", config, halfspace::c::kBvhDefaults);
    halfspace::c::CallerThreads threads(call, "config->run", read.run,
                                        read.run_context);
    halfspace::BuildOptions options;
    options.quality = halfspace::c::ReadQuality(call, read.quality);
    options.target = halfspace::c::ReadTarget(call, "config", read.target);
    options.run = threads.runner();
    options.query_extents = halfspace::c::ReadExtents(
        call, "config->query_extents", bvh->layout, read.query_extents);
    bvh->core.Rebuild(options);
  });
}

hs_status hs_bvh_cost_ratio(const hs_bvh* bvh, double* ratio) {
  return Get("hs_bvh_cost_ratio", "bvh", bvh, "ratio", ratio,
             [&] { return bvh->core.CostRatio(); });
}

hs_status hs_bvh_expected_leaves(const hs_bvh* bvh, const float* extents,
                                 double* leaves) {
  return Run("hs_bvh_expected_leaves", [&](const Call& call) {
    call.CheckPointer("bvh", bvh);
    if (!bvh->layout.has_max) {
      call.Fail(HS_INVALID_ARGUMENT, "bvh",
                "expected a BVH of boxes or octahedra, got one of simplices");
    }
    call.CheckPointer("extents", extents);
    call.CheckPointer("leaves", leaves);
    const auto read =
        halfspace::c::ReadExtents(call, "extents", bvh->layout, extents);
    *leaves = bvh->core.ExpectedLeaves({read->data(), read->size()});
  });
}
