#include "bench/worlds/in_cache.h"

#include <algorithm>
#include <span>
#include <utility>

#include "bench/worlds/working_set.h"
#include "halfspace/reject_many.h"
#include "tests/reference/reference.h"

namespace halfspace::bench {
namespace {

// So many that their masks stay in the cache with the planes.
constexpr std::size_t kQueries = 16;

std::size_t ObjectsInHalf(const Machine& machine, ShapeKind shape) {
  const std::size_t record = PlaneCountOf(shape) * sizeof(float);
  return std::max<std::size_t>(64,
                               machine.CacheBytes(1) / 2 / record / 64 * 64);
}

}  // namespace

InCache::InCache(const Workload& workload, const Machine& machine,
                 ShapeKind shape)
    : shape_(shape),
      world_(ResizedTo(workload.objects, ObjectsInHalf(machine, shape))),
      queries_(std::span(workload.queries)
                   .first(std::min(kQueries, workload.queries.size()))),
      rounds_(std::max<std::size_t>(
          1, kObjectsPerRun / (world_.size() * queries_.size()))),
      rows_(queries_.size() * MaskWords(world_.size())),
      expected_(rows_.size()) {
  const std::size_t words = MaskWords(world_.size());
  queries_.With(shape_, view(), [&](const auto& view, const auto& queries) {
    for (std::size_t q = 0; q < queries.size(); ++q) {
      reference::RejectMask(view, queries[q], &expected_[q * words]);
    }
  });
}

double InCache::items() const {
  return static_cast<double>(rounds_ * queries_.size() * world_.size());
}

Case InCache::MasksCase(std::string name, Target target) {
  const auto write = [this, target] {
    queries_.With(shape_, view(), [&](const auto& view, const auto& queries) {
      RejectMasks(view, queries, rows_,
                  {.schedule = Schedule::kFlat, .target = target});
    });
  };
  Case c;
  c.name = std::move(name);
  c.items = items();
  c.check = [this, write]() -> std::string {
    std::fill(rows_.begin(), rows_.end(), 0x5555555555555555);
    write();
    return rows_ == expected_ ? "" : "the masks are not the scalar reference's";
  };
  c.run = [write, rounds = rounds_] {
    for (std::size_t i = 0; i < rounds; ++i) write();
  };
  return c;
}

}  // namespace halfspace::bench
