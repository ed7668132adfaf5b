// The calls of reject_shapes.h. Half-spaces become the query of a scan, which
// the calls of reject.h run.
#include "halfspace/reject_shapes.h"

#include <cstddef>
#include <cstdint>
#include <string>

#include "dispatch/errors/error.h"
#include "dispatch/errors/memory_checks.h"
#include "dispatch/exact/default_fp_mode.h"
#include "kernels/compiler.h"
#include "kernels/scan/half_spaces.h"

namespace halfspace::detail {
namespace {

// Runs a scan of half-spaces as a scan with queries. A function of its own,
// because its list would make the stack frame of its caller large.
template <typename Ask>
HALFSPACE_NOINLINE auto WithQuery(HalfSpaceScan& fronts, const char* call,
                                  const Ask& ask) {
  if (fronts.count > kMostHalfSpaces) {
    dispatch::ThrowInvalid(call, "half-spaces",
                           "at most " + std::to_string(kMostHalfSpaces),
                           std::to_string(fronts.count));
  }
  dispatch::CheckMemory(call, "half-spaces", fronts.values, fronts.count,
                        alignof(float));
  ScanType type = *fronts.scan.type;
  Fronts query;
  dispatch::InDefaultFpMode([&] {
    query.count = fronts.count;
    for (std::size_t f = 0; f < query.count; ++f) {
      const float* const normal = fronts.values + f * (type.dims + 1u);
      query.front[f] = MakeFront(type, normal, normal[type.dims]);
    }
  });
  type.all_kernels = &KernelsOfAll<TargetKernels>::kTargets;
  fronts.scan.type = &type;
  fronts.scan.queries = &query;
  fronts.scan.query_count = 1;
  return ask(fronts.scan);
}

}  // namespace

void RejectMask(HalfSpaceScan&& fronts, Span<std::uint64_t> mask,
                const Options& options) {
  WithQuery(fronts, "RejectMask",
            [&](const Scan& scan) { RejectMask(Scan(scan), mask, options); });
}

void SurvivorMask(HalfSpaceScan&& fronts, Span<std::uint64_t> mask,
                  const Options& options) {
  WithQuery(fronts, "SurvivorMask",
            [&](const Scan& scan) { SurvivorMask(Scan(scan), mask, options); });
}

std::size_t Survivors(HalfSpaceScan&& fronts, Span<std::uint32_t> indices,
                      const Options& options, std::size_t skip) {
  return WithQuery(fronts, "Survivors", [&](const Scan& scan) {
    return Survivors(Scan(scan), indices, options, skip);
  });
}

std::size_t CountSurvivors(HalfSpaceScan&& fronts, const Options& options) {
  return WithQuery(fronts, "CountSurvivors", [&](const Scan& scan) {
    return CountSurvivors(Scan(scan), options);
  });
}

std::size_t AnySurvivor(HalfSpaceScan&& fronts, const Options& options) {
  return WithQuery(fronts, "AnySurvivor", [&](const Scan& scan) {
    return AnySurvivor(Scan(scan), options);
  });
}

void ForEachSurvivor(HalfSpaceScan&& fronts, SomeFunction function,
                     void* context, const Options& options) {
  WithQuery(fronts, "ForEachSurvivor", [&](const Scan& scan) {
    ForEachSurvivor(Scan(scan), function, context, options);
  });
}

}  // namespace halfspace::detail
