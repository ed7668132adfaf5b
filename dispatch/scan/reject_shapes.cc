// The calls of reject_shapes.h. Half-spaces become the query of a scan, which
// the calls of reject.h run.
#include "halfspace/reject_shapes.h"

#include <cstddef>
#include <cstdint>
#include <string>

#include "dispatch/default_fp_mode.h"
#include "dispatch/errors/error.h"
#include "dispatch/errors/memory_checks.h"
#include "kernels/compiler.h"
#include "kernels/scan/half_spaces.h"

namespace halfspace::detail {
namespace {

// Runs a scan of half-spaces as a scan with queries. A function of its own,
// because its list would make the stack frame of its caller large.
template <typename Ask>
HALFSPACE_NOINLINE auto WithQuery(HalfSpaceScan& half_spaces, const char* call,
                                  const Ask& ask) {
  if (half_spaces.count > kMostHalfSpaces) {
    dispatch::ThrowInvalid(call, "half-spaces",
                           "at most " + std::to_string(kMostHalfSpaces),
                           std::to_string(half_spaces.count));
  }
  dispatch::CheckMemory(call, "half-spaces", half_spaces.values,
                        half_spaces.count, alignof(float));
  ScanType type = *half_spaces.scan.type;
  HalfSpaceTests query;
  dispatch::InDefaultFpMode([&] {
    query.count = half_spaces.count;
    for (std::size_t f = 0; f < query.count; ++f) {
      const float* const normal = half_spaces.values + f * (type.dims + 1u);
      query.test[f] = MakeHalfSpaceTest(type, normal, normal[type.dims]);
    }
  });
  type.all_kernels = &KernelsOfAll<TargetKernels>::kTargets;
  half_spaces.scan.type = &type;
  half_spaces.scan.queries = &query;
  half_spaces.scan.query_count = 1;
  return ask(half_spaces.scan);
}

}  // namespace

void RejectMask(HalfSpaceScan&& half_spaces, Span<std::uint64_t> mask,
                const Options& options) {
  WithQuery(half_spaces, "RejectMask",
            [&](const Scan& scan) { RejectMask(Scan(scan), mask, options); });
}

void SurvivorMask(HalfSpaceScan&& half_spaces, Span<std::uint64_t> mask,
                  const Options& options) {
  WithQuery(half_spaces, "SurvivorMask",
            [&](const Scan& scan) { SurvivorMask(Scan(scan), mask, options); });
}

std::size_t Survivors(HalfSpaceScan&& half_spaces, Span<std::uint32_t> indices,
                      const Options& options, std::size_t skip) {
  return WithQuery(half_spaces, "Survivors", [&](const Scan& scan) {
    return Survivors(Scan(scan), indices, options, skip);
  });
}

std::size_t CountSurvivors(HalfSpaceScan&& half_spaces,
                           const Options& options) {
  return WithQuery(half_spaces, "CountSurvivors", [&](const Scan& scan) {
    return CountSurvivors(Scan(scan), options);
  });
}

std::size_t AnySurvivor(HalfSpaceScan&& half_spaces, const Options& options) {
  return WithQuery(half_spaces, "AnySurvivor", [&](const Scan& scan) {
    return AnySurvivor(Scan(scan), options);
  });
}

void ForEachSurvivor(HalfSpaceScan&& half_spaces, SomeFunction function,
                     void* context, const Options& options) {
  WithQuery(half_spaces, "ForEachSurvivor", [&](const Scan& scan) {
    ForEachSurvivor(Scan(scan), function, context, options);
  });
}

}  // namespace halfspace::detail
