// What the functions of broad phases share.
#ifndef HALFSPACE_C_BROAD_PHASE_H_
#define HALFSPACE_C_BROAD_PHASE_H_

#include <cstddef>

#include "c/call.h"
#include "c/columns.h"
#include "halfspace/broad_phase.h"
#include "halfspace/bvh_pairs.h"
#include "halfspace/detail/broad_phase.h"
#include "halfspace/detail/pair_events.h"
#include "halfspace/memory.h"
#include "halfspace/span.h"

// Below the template of broad_phase.h, so that there is one for all kinds.
struct hs_broad_phase {
  hs_broad_phase(const halfspace::detail::PlaneLayout& its_layout,
                 const halfspace::BroadPhaseOptions& options);

  const halfspace::detail::PairEventsCore& events() const {
    return core.events();
  }

  const halfspace::detail::PlaneLayout layout;
  const halfspace::c::Values objects;
  const halfspace::MemoryResource memory;
  halfspace::detail::BroadPhaseCore core;
};

namespace halfspace::c {

// Writes where a list of the pair events of a broad phase, or of a
// hs_pair_events, is.
template <typename From>
hs_status ListPairs(const char* name, const char* from_name, const From* from,
                    Span<const IdPair> (detail::PairEventsCore::*list)() const,
                    const hs_id_pair** pairs, std::size_t* count) {
  return Run(name, [&](const Call& call) {
    call.CheckPointer(from_name, from);
    call.CheckPointer("pairs", pairs);
    call.CheckPointer("count", count);
    const Span<const IdPair> found = (from->events().*list)();
    *pairs = reinterpret_cast<const hs_id_pair*>(found.data());
    *count = found.size();
  });
}

}  // namespace halfspace::c

#endif  // HALFSPACE_C_BROAD_PHASE_H_
