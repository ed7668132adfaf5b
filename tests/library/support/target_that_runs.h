// Which target's kernels a scan calls: no public call says it.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_TARGET_THAT_RUNS_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_TARGET_THAT_RUNS_H_

#include "halfspace/reject.h"
#include "halfspace/target.h"
#include "kernels/scan/kernel_table.h"
#include "tests/library/support/any_world.h"

namespace halfspace::testing {

// Each call of reject.h and reject_many.h takes its kernels as this one does.
inline Target TargetThatRuns(const AnyWorld& world, const AnyQueries& query,
                             const Options& options) {
  detail::Scan scan = world.Asked(query);
  // The call writes its kernels there.
  static_cast<void>(
      detail::CountSurvivors(static_cast<detail::Scan&&>(scan), options));
  // The kernel says which target it was compiled for: no queries, no objects.
  detail::Chunk nothing{};
  nothing.queries = query.records;
  return Target::FromHighwayBit(
      scan.kernels->run[scan.type->flat](scan, nothing));
}
template <typename World>
Target TargetThatRuns(const World& world, const typename World::Query& query,
                      const Options& options) {
  return TargetThatRuns(AnyWorld(world), {&query, 1}, options);
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_TARGET_THAT_RUNS_H_
