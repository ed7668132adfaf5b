// The calls of reject_shapes.h. A shape becomes the query of a scan, which the
// calls of reject.h run.
#include "halfspace/reject_shapes.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include "dispatch/default_fp_mode.h"
#include "dispatch/errors/error.h"
#include "dispatch/errors/memory_checks.h"
#include "dispatch/errors/number_checks.h"
#include "dispatch/scan/prepare.h"
#include "kernels/compiler.h"
#include "kernels/scan/half_spaces.h"

namespace halfspace::detail {
namespace {

// Calls ask(scan, query) with a shape as the query of a scan. A function of its
// own, because its list would make the stack frame of its caller large.
template <typename Ask>
HALFSPACE_NOINLINE void WithQuery(const ShapeScan& shape, const char* call,
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
  Scan scan = shape.scan;
  scan.type = &type;
  scan.queries = &query;
  scan.query_count = 1;
  ask(std::move(scan), query);
}

}  // namespace

void RunShape(const ShapeScan& shape, const char* call,
              void (*run)(void* context, Scan&& scan), void* context) {
  WithQuery(shape, call, [&](Scan&& scan, HalfSpaceQuery&) {
    run(context, std::move(scan));
  });
}

void ClassifyMasks(const ShapeScan& shape, Span<std::uint64_t> survivors,
                   Span<std::uint64_t> inside, const Options& options) {
  constexpr const char* kCall = "ClassifyMasks";
  WithQuery(shape, kCall, [&](Scan&& scan, HalfSpaceQuery& query) {
    std::size_t words = 0;
    const auto prepare = [&](const char* name, Span<std::uint64_t> mask) {
      dispatch::Prepare(scan, options, kCall, [&](std::size_t objects) {
        words = MaskWords(objects);
        return dispatch::CallOutput{name, mask.data(), mask.size(), words,
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
