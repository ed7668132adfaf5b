// The calls of reject_shapes.h. A shape becomes the query of a scan, which the
// calls of reject.h run.
#include "halfspace/reject_shapes.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>

#include "dispatch/default_fp_mode.h"
#include "dispatch/errors/error.h"
#include "dispatch/errors/memory_checks.h"
#include "dispatch/errors/number_checks.h"
#include "dispatch/scan/prepare.h"
#include "kernels/compiler.h"
#include "kernels/scan/half_spaces.h"

namespace halfspace::detail {
namespace {

// Runs a scan of a shape as a scan with a query. A function of its own,
// because its list would make the stack frame of its caller large.
template <typename Ask>
HALFSPACE_NOINLINE auto WithQuery(ShapeScan& shape, const char* call,
                                  const Ask& ask) {
  if (shape.count > kMostHalfSpaces) {
    dispatch::ThrowInvalid(call, "half-spaces",
                           "at most " + std::to_string(kMostHalfSpaces),
                           std::to_string(shape.count));
  }
  dispatch::CheckMemory(call, "half-spaces", shape.half_spaces, shape.count,
                        alignof(float));
  dispatch::CheckLength(call, "query.radius", shape.radius);
  ScanType type = *shape.scan.type;
  HalfSpaceQuery query;
  dispatch::InDefaultFpMode([&] { MakeHalfSpaceQuery(type, shape, query); });
  type.all_kernels = &KernelsOfAll<TargetKernels>::kTargets;
  shape.scan.type = &type;
  shape.scan.queries = &query;
  shape.scan.query_count = 1;
  return ask(shape.scan, query);
}

}  // namespace

void RejectMask(ShapeScan&& shape, Span<std::uint64_t> mask,
                const Options& options) {
  WithQuery(shape, "RejectMask", [&](const Scan& scan, HalfSpaceQuery&) {
    RejectMask(Scan(scan), mask, options);
  });
}

void SurvivorMask(ShapeScan&& shape, Span<std::uint64_t> mask,
                  const Options& options) {
  WithQuery(shape, "SurvivorMask", [&](const Scan& scan, HalfSpaceQuery&) {
    SurvivorMask(Scan(scan), mask, options);
  });
}

std::size_t Survivors(ShapeScan&& shape, Span<std::uint32_t> indices,
                      const Options& options, std::size_t skip) {
  return WithQuery(shape, "Survivors", [&](const Scan& scan, HalfSpaceQuery&) {
    return Survivors(Scan(scan), indices, options, skip);
  });
}

std::size_t CountSurvivors(ShapeScan&& shape, const Options& options) {
  return WithQuery(shape, "CountSurvivors",
                   [&](const Scan& scan, HalfSpaceQuery&) {
                     return CountSurvivors(Scan(scan), options);
                   });
}

std::size_t AnySurvivor(ShapeScan&& shape, const Options& options) {
  return WithQuery(shape, "AnySurvivor",
                   [&](const Scan& scan, HalfSpaceQuery&) {
                     return AnySurvivor(Scan(scan), options);
                   });
}

void ForEachSurvivor(ShapeScan&& shape, SomeFunction function, void* context,
                     const Options& options) {
  WithQuery(shape, "ForEachSurvivor", [&](const Scan& scan, HalfSpaceQuery&) {
    ForEachSurvivor(Scan(scan), function, context, options);
  });
}

void ClassifyMasks(ShapeScan&& shape, Span<std::uint64_t> survivors,
                   Span<std::uint64_t> inside, const Options& options) {
  constexpr const char* kCall = "ClassifyMasks";
  WithQuery(shape, kCall, [&](const Scan& checked, HalfSpaceQuery& query) {
    Scan scan = checked;
    std::size_t words = 0;
    const auto prepare = [&](const char* name, Span<std::uint64_t> mask) {
      dispatch::Prepare(scan, options, kCall, [&](std::size_t objects) {
        words = MaskWords(objects);
        return dispatch::Output{name, mask.data(), mask.size(), words,
                                sizeof(std::uint64_t)};
      });
    };
    prepare("survivors", survivors);
    prepare("inside", inside);
    if (dispatch::Overlap(survivors.data(), words * sizeof(std::uint64_t),
                          inside.data(), words * sizeof(std::uint64_t))) {
      dispatch::ThrowOverlap(kCall, "inside", "the survivors",
                             "an overlap with them");
    }
    dispatch::WriteWords(scan, options, survivors.data());
    std::copy_n(survivors.data(), words, inside.data());
    query.only_insides = true;
    dispatch::WriteWords(scan, options, inside.data());
  });
}

}  // namespace halfspace::detail
