// Which target's kernels a scan calls: no public call says it.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_TARGET_THAT_RUNS_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_TARGET_THAT_RUNS_H_

#include <cstddef>

#include "halfspace/reject.h"
#include "halfspace/target.h"
#include "kernels/scan/kernel_table.h"

namespace halfspace::testing {

// Each call of reject.h and reject_many.h takes its kernels as this one does.
template <typename AnyWorld>
Target TargetThatRuns(const AnyWorld& world,
                      const typename AnyWorld::Query& query,
                      const Options& options) {
  const auto view = world.view();
  detail::Scan scan = detail::ScanOf(view, &query, 1);
  // The call writes its kernels there.
  static_cast<void>(
      detail::CountSurvivors(static_cast<detail::Scan&&>(scan), options));
  // The kernel says which target it was compiled for: no queries, no objects.
  detail::Part nothing{};
  nothing.queries = &query;
  return Target::FromHighwayBit(
      scan.kernels->run[scan.type->flat](scan, nothing));
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_TARGET_THAT_RUNS_H_
