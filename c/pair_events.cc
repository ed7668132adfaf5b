// hs_pair_events_...(): the pairs of a BVH that began and ended.
#include "halfspace/pair_events.h"

#include <cstddef>
#include <cstdint>

#include "c/broad_phase.h"
#include "c/bvh.h"
#include "c/call.h"

using halfspace::IdPair;
using halfspace::Span;
using halfspace::c::Call;
using halfspace::c::CallerThreads;
using halfspace::c::ListPairs;
using halfspace::c::Run;
namespace detail = halfspace::detail;

struct hs_pair_events {
  explicit hs_pair_events(const halfspace::MemoryResource& memory)
      : core(memory) {}

  const detail::PairEventsCore& events() const { return core; }

  detail::PairEventsCore core;
};

namespace halfspace::c {
namespace {

constexpr hs_pair_event_options kPairEventDefaults = {
    sizeof(hs_pair_event_options), 0xFFFFFFFF, 0.0f, nullptr, nullptr, nullptr};

// `changed` is null for all objects.
void Update(const Call& call, hs_pair_events* events, const hs_bvh* bvh,
            const Span<const std::uint32_t>* changed,
            const hs_pair_event_options* options) {
  call.CheckPointer("events", events);
  call.CheckPointer("bvh", bvh);
  const hs_pair_event_options read =
      ReadOptions(call, "options", options, kPairEventDefaults);
  CallerThreads threads(call, "options->run", read.run, read.run_context);
  events->core.Update(
      {PairKernelsOf(call, bvh->layout), &bvh->core, nullptr, changed},
      {.mask = read.mask,
       .margin = read.margin,
       .run = threads.runner(),
       .target = ReadTarget(call, "options", read.target)});
}

}  // namespace
}  // namespace halfspace::c

HALFSPACE_DEFAULTS_OF(hs_pair_event_options, kPairEventDefaults)

hs_status hs_pair_events_create(const hs_allocator* allocator,
                                hs_pair_events** events) {
  return Run("hs_pair_events_create", [&](const Call& call) {
    call.CheckPointer("events", events);
    halfspace::MemoryResource memory;
    if (allocator != nullptr) {
      call.CheckPointer("allocator", allocator);
      memory = halfspace::c::ReadAllocator(call, *allocator, "allocator");
    }
    *events = halfspace::c::New<hs_pair_events>(memory, memory);
  });
}

void hs_pair_events_destroy(hs_pair_events* events) {
  if (events != nullptr) halfspace::c::Delete(events->core.memory(), events);
}

hs_status hs_pair_events_update(hs_pair_events* events, const hs_bvh* bvh,
                                const hs_pair_event_options* options) {
  return Run("hs_pair_events_update", [&](const Call& call) {
    halfspace::c::Update(call, events, bvh, nullptr, options);
  });
}

hs_status hs_pair_events_update_of(hs_pair_events* events, const hs_bvh* bvh,
                                   const uint32_t* changed, size_t count,
                                   const hs_pair_event_options* options) {
  return Run("hs_pair_events_update_of", [&](const Call& call) {
    call.CheckArray("changed", changed, count);
    const Span<const std::uint32_t> ids(changed, count);
    halfspace::c::Update(call, events, bvh, &ids, options);
  });
}

hs_status hs_pair_events_pairs(const hs_pair_events* events,
                               const hs_id_pair** pairs, size_t* count) {
  return ListPairs("hs_pair_events_pairs", "events", events,
                   &detail::PairEventsCore::pairs, pairs, count);
}

hs_status hs_pair_events_began(const hs_pair_events* events,
                               const hs_id_pair** pairs, size_t* count) {
  return ListPairs("hs_pair_events_began", "events", events,
                   &detail::PairEventsCore::began, pairs, count);
}

hs_status hs_pair_events_ended(const hs_pair_events* events,
                               const hs_id_pair** pairs, size_t* count) {
  return ListPairs("hs_pair_events_ended", "events", events,
                   &detail::PairEventsCore::ended, pairs, count);
}

hs_status hs_pair_events_load(hs_pair_events* events, const hs_id_pair* pairs,
                              size_t count) {
  return Run("hs_pair_events_load", [&](const Call& call) {
    call.CheckPointer("events", events);
    call.CheckArray("pairs", pairs, count);
    events->core.Load({reinterpret_cast<const IdPair*>(pairs), count});
  });
}
