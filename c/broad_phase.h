// What the functions of broad phases share.
#ifndef HALFSPACE_C_BROAD_PHASE_H_
#define HALFSPACE_C_BROAD_PHASE_H_

#include "c/columns.h"
#include "halfspace/broad_phase.h"
#include "halfspace/detail/broad_phase.h"
#include "halfspace/memory.h"

// Below the template of broad_phase.h, so that there is one for all kinds.
struct hs_broad_phase {
  hs_broad_phase(const halfspace::detail::PlaneLayout& its_layout,
                 const halfspace::BroadPhaseOptions& options);

  const halfspace::detail::PlaneLayout layout;
  const halfspace::c::Values objects;
  const halfspace::MemoryResource memory;
  halfspace::detail::BroadPhaseCore core;
};

#endif  // HALFSPACE_C_BROAD_PHASE_H_
