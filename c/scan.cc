// hs_scan_...(): flat scans.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include "c/call.h"
#include "c/columns.h"
#include "halfspace/quantized.h"
#include "halfspace/reject.h"
#include "halfspace/reject_many.h"
#include "halfspace/world.h"

// One class for each type of world, which makes the same call of the library.
struct hs_scan {
  explicit hs_scan(const halfspace::detail::PlaneLayout& layout)
      : queries(halfspace::c::Values::OfQueries(layout)) {}
  hs_scan(const hs_scan&) = delete;
  hs_scan& operator=(const hs_scan&) = delete;
  virtual ~hs_scan() = default;

  virtual std::size_t size() const = 0;
  virtual halfspace::detail::Scan ScanOf(const float* rows,
                                         std::size_t count) const = 0;
  virtual void Destroy() noexcept = 0;

  const halfspace::c::Values queries;
};

namespace halfspace::c {
namespace {

constexpr hs_scan_config kDefaultConfig = {
    sizeof(hs_scan_config), static_cast<hs_kind>(0), 0, {}};
constexpr hs_scan_options kDefaultOptions = {
    sizeof(hs_scan_options), 0, std::numeric_limits<std::size_t>::max(), 0,
    nullptr};

template <typename AnyWorld>
class ScanOfWorld final : public hs_scan {
 public:
  using Query = typename AnyWorld::Query;

  template <typename... Arguments>
  explicit ScanOfWorld(Arguments&&... of_world)
      : hs_scan(detail::kLayoutOf<typename AnyWorld::Bound>),
        world_(std::forward<Arguments>(of_world)...),
        view_(world_.view()) {}

  std::size_t size() const override { return world_.size(); }
  detail::Scan ScanOf(const float* rows, std::size_t count) const override {
    return detail::ScanOf(view_, reinterpret_cast<const Query*>(rows), count);
  }
  void Destroy() noexcept override { Delete(world_.memory(), this); }

 private:
  AnyWorld world_;
  decltype(std::declval<const AnyWorld&>().view()) view_;
};

template <typename View>
World<View> WorldOf(const hs_columns& objects, const MemoryResource& memory) {
  const Values values =
      Values::OfObjects(detail::kLayoutOf<typename View::Bound>);
  World<View> world(memory);
  world.Resize(objects.count);
  const auto planes = world.planes();
  std::array<float*, kMostValues> to{};
  std::size_t planes_count = 0;
  for (float* plane : planes.min) to[planes_count++] = plane;
  if constexpr (detail::HasMax<View>) {
    for (float* plane : planes.max) to[planes_count++] = plane;
  }
  ForEachRows(objects, values,
              [&](const float* rows, std::size_t begin, std::size_t count) {
                for (std::size_t v = 0; v < values.count; ++v) {
                  for (std::size_t i = 0; i < count; ++i) {
                    to[v][begin + i] = rows[i * values.count + v];
                  }
                }
              });
  return world;
}

template <typename View>
hs_scan* ScanWithBits(const Call& call, int bits, const hs_columns& objects,
                      const MemoryResource& memory) {
  World<View> world = WorldOf<View>(objects, memory);
  switch (bits) {
    case 0:
      return New<ScanOfWorld<World<View>>>(memory, std::move(world));
    case 8:
      return New<ScanOfWorld<QuantizedWorld<View, std::uint8_t>>>(memory, world,
                                                                  memory);
    case 16:
      return New<ScanOfWorld<QuantizedWorld<View, std::uint16_t>>>(
          memory, world, memory);
    default:
      call.Fail(HS_INVALID_ARGUMENT, "config->bits",
                "expected 0, 8 or 16, got %d", bits);
  }
}

hs_scan* NewScan(const Call& call, const hs_scan_config& config,
                 const hs_columns& objects, const MemoryResource& memory) {
  const PlaneLayout layout = LayoutOf(call, "config->kind", config.kind);
  return WithView(layout, [&]<typename View>(const View&) {
    return ScanWithBits<View>(call, config.bits, objects, memory);
  });
}

// What the queries share.
struct ScanCall {
  ScanCall(const Call& call, const hs_scan* scan, const hs_columns* queries,
           const hs_scan_options* options) {
    call.CheckPointer("scan", scan);
    CheckColumns(call, "queries", queries, scan->queries);
    const hs_scan_options read =
        ReadOptions(call, "options", options, kDefaultOptions);
    if (read.begin > read.end) {
      call.Fail(HS_INVALID_ARGUMENT, "options",
                "expected a `begin` of at most `end`, got %zu and %zu",
                read.begin, read.end);
    }
    its_options.range = {read.begin, read.end};
    skip = read.skip;
    its_options.target = ReadTarget(call, "options", read.target);
  }

  Options its_options;
  size_t skip;
};

}  // namespace
}  // namespace halfspace::c

using halfspace::c::Call;
using halfspace::c::ForEachRows;
using halfspace::c::ResultRoom;
using halfspace::c::Run;
using halfspace::c::ScanCall;
namespace detail = halfspace::detail;

HALFSPACE_DEFAULTS_OF(hs_scan_config, kDefaultConfig)
HALFSPACE_DEFAULTS_OF(hs_scan_options, kDefaultOptions)

hs_status hs_scan_create(const hs_scan_config* config,
                         const hs_columns* objects, hs_scan** scan) {
  return Run("hs_scan_create", [&](const Call& call) {
    call.CheckPointer("scan", scan);
    const hs_scan_config read =
        halfspace::c::ReadConfig(call, config, halfspace::c::kDefaultConfig);
    halfspace::c::CheckColumns(
        call, "objects", objects,
        halfspace::c::Values::OfObjects(
            halfspace::c::LayoutOf(call, "config->kind", read.kind)));
    *scan = halfspace::c::NewScan(
        call, read, *objects,
        halfspace::c::ReadAllocator(call, read.allocator));
  });
}

void hs_scan_destroy(hs_scan* scan) {
  if (scan != nullptr) scan->Destroy();
}

hs_status hs_scan_size(const hs_scan* scan, size_t* size) {
  return halfspace::c::Get("hs_scan_size", "scan", scan, "size", size,
                           [&] { return scan->size(); });
}

hs_status hs_scan_masks(const hs_scan* scan, const hs_columns* queries,
                        const hs_scan_options* options, uint64_t* masks,
                        size_t words) {
  return Run("hs_scan_masks", [&](const Call& call) {
    const ScanCall scans(call, scan, queries, options);
    const size_t size = scan->size();
    const size_t row =
        hs_mask_words(std::min(scans.its_options.range.end, size) -
                      std::min(scans.its_options.range.begin, size));
    if (row != 0 && words / row < queries->count) {
      call.Fail(HS_INVALID_ARGUMENT, "words",
                "expected at least %zu for each of %zu queries, got %zu", row,
                queries->count, words);
    }
    call.CheckArray("masks", masks, row * queries->count);
    ForEachRows(*queries, scan->queries,
                [&](const float* rows, size_t begin, size_t count) {
                  const halfspace::Span<uint64_t> to = {masks + begin * row,
                                                        count * row};
                  if (count == 1) {
                    detail::SurvivorMask(scan->ScanOf(rows, 1), to,
                                         scans.its_options);
                    return;
                  }
                  detail::SurvivorMasks(scan->ScanOf(rows, count), to,
                                        scans.its_options, 0);
                });
  });
}

hs_status hs_scan_indices(const hs_scan* scan, const hs_columns* queries,
                          const hs_scan_options* options, uint32_t* indices,
                          size_t room, size_t* offsets, size_t* total) {
  return Run("hs_scan_indices", [&](const Call& call) {
    const ScanCall scans(call, scan, queries, options);
    call.CheckArray("indices", indices, room);
    call.CheckPointer("total", total);
    if (offsets != nullptr) {
      call.CheckPointer("offsets", offsets);
      offsets[0] = 0;
    }
    ResultRoom<uint32_t> results(indices, room, scans.skip);
    ForEachRows(*queries, scan->queries,
                [&](const float* rows, size_t begin, size_t count) {
                  for (size_t q = 0; q < count; ++q) {
                    results.Add(detail::Survivors(
                        scan->ScanOf(rows + q * scan->queries.count, 1),
                        results.span(), scans.its_options, results.skip()));
                    if (offsets != nullptr) {
                      offsets[begin + q + 1] = results.total();
                    }
                  }
                });
    *total = results.total();
  });
}

hs_status hs_scan_counts(const hs_scan* scan, const hs_columns* queries,
                         const hs_scan_options* options, size_t* counts) {
  return Run("hs_scan_counts", [&](const Call& call) {
    const ScanCall scans(call, scan, queries, options);
    call.CheckArray("counts", counts, queries->count);
    ForEachRows(*queries, scan->queries,
                [&](const float* rows, size_t begin, size_t count) {
                  if (count == 1) {
                    counts[begin] = detail::CountSurvivors(
                        scan->ScanOf(rows, 1), scans.its_options);
                    return;
                  }
                  detail::SurvivorCounts(scan->ScanOf(rows, count),
                                         {counts + begin, count},
                                         scans.its_options);
                });
  });
}

hs_status hs_scan_any(const hs_scan* scan, const hs_columns* queries,
                      const hs_scan_options* options, uint32_t* indices) {
  return Run("hs_scan_any", [&](const Call& call) {
    const ScanCall scans(call, scan, queries, options);
    call.CheckArray("indices", indices, queries->count);
    ForEachRows(*queries, scan->queries,
                [&](const float* rows, size_t begin, size_t count) {
                  for (size_t q = 0; q < count; ++q) {
                    const size_t found = detail::AnySurvivor(
                        scan->ScanOf(rows + q * scan->queries.count, 1),
                        scans.its_options);
                    indices[begin + q] = found == detail::kNoSurvivor
                                             ? HS_NO_ID
                                             : static_cast<uint32_t>(found);
                  }
                });
  });
}

hs_status hs_scan_pairs(const hs_scan* scan, const hs_columns* queries,
                        const hs_scan_options* options, uint32_t* query_indices,
                        uint32_t* object_indices, size_t room, size_t* total) {
  return Run("hs_scan_pairs", [&](const Call& call) {
    const ScanCall scans(call, scan, queries, options);
    call.CheckArray("query_indices", query_indices, room);
    call.CheckArray("object_indices", object_indices, room);
    call.CheckPointer("total", total);
    if (queries->count > UINT32_MAX) {
      call.Fail(HS_INVALID_ARGUMENT, "queries->count",
                "expected fewer than 2^32, got %zu", queries->count);
    }
    ResultRoom<uint32_t> of_queries(query_indices, room, scans.skip);
    ResultRoom<uint32_t> of_objects(object_indices, room, scans.skip);
    ForEachRows(*queries, scan->queries,
                [&](const float* rows, size_t begin, size_t count) {
                  const size_t written = of_queries.written();
                  const size_t found = detail::SurvivorPairs(
                      scan->ScanOf(rows, count), of_queries.span(),
                      of_objects.span(), scans.its_options, of_queries.skip());
                  of_queries.Add(found);
                  of_objects.Add(found);
                  for (size_t i = written; i < of_queries.written(); ++i) {
                    query_indices[i] += static_cast<uint32_t>(begin);
                  }
                });
    *total = of_queries.total();
  });
}
