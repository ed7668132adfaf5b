// The calls of reject_shapes.h. A shape becomes the query of a scan, which the
// calls of reject.h run.
#include "halfspace/reject_shapes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>

#include "dispatch/default_fp_mode.h"
#include "dispatch/errors/error.h"
#include "dispatch/errors/memory_checks.h"
#include "dispatch/errors/number_checks.h"
#include "kernels/compiler.h"
#include "kernels/scan/half_spaces.h"

namespace halfspace::detail {
namespace {

void MakeQuery(const ScanType& type, const ShapeScan& shape,
               HalfSpaceQuery& query) {
  HalfSpaceTests& tests = query.tests;
  MakeHalfSpaceTests(type, shape.half_spaces, shape.count, tests);
  query.rejects_all = false;
  std::uint8_t listed = 0;
  query.end[0] = 0;
  for (std::size_t terms = 1; terms <= kMostTerms; ++terms) {
    for (std::size_t f = 0; f < tests.count; ++f) {
      if (tests.test[f].terms != terms) continue;
      query.order[listed++] = static_cast<std::uint8_t>(f);
    }
    query.end[terms] = listed;
  }
  for (std::size_t f = 0; f < tests.count; ++f) {
    HalfSpaceTest& test = tests.test[f];
    query.rejects_all |= test.terms == 0 && test.offset < 0;
    for (std::size_t t = test.terms; t < kMostTerms; ++t) {
      test.term[t].plane = test.term[0].plane;
    }
  }
  query.minima = type.has_max ? type.dims : type.plane_count;
  query.maxima = type.has_max ? type.dims : 0;
  // Also for NaN. Of a sphere that touches the box the center is anywhere.
  query.slack = std::numeric_limits<float>::infinity();
  query.near_dims = 0;
  const bool is_near = shape.low != nullptr;
  if (!is_near && tests.box_dims == 0) return;
  float most = 0;
  for (std::size_t k = 0; k < type.dims; ++k) {
    const float low = is_near ? shape.low[k] : tests.low[k];
    const float high = is_near ? shape.high[k] : tests.high[k];
    query.box[k] = low;
    query.box[type.dims + k] = high;
    most = std::max({most, std::abs(low), std::abs(high)});
  }
  if (type.kind != PlaneLayout::kSphere) {
    query.slack = kSumSlack * most + 0x1p-110f;
    return;
  }
  query.near_dims = type.dims;
  query.radius = shape.radius;
  tests.box_dims = 0;
}

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
  dispatch::InDefaultFpMode([&] { MakeQuery(type, shape, query); });
  type.all_kernels = &KernelsOfAll<TargetKernels>::kTargets;
  shape.scan.type = &type;
  shape.scan.queries = &query;
  shape.scan.query_count = 1;
  return ask(shape.scan);
}

}  // namespace

void RejectMask(ShapeScan&& shape, Span<std::uint64_t> mask,
                const Options& options) {
  WithQuery(shape, "RejectMask",
            [&](const Scan& scan) { RejectMask(Scan(scan), mask, options); });
}

void SurvivorMask(ShapeScan&& shape, Span<std::uint64_t> mask,
                  const Options& options) {
  WithQuery(shape, "SurvivorMask",
            [&](const Scan& scan) { SurvivorMask(Scan(scan), mask, options); });
}

std::size_t Survivors(ShapeScan&& shape, Span<std::uint32_t> indices,
                      const Options& options, std::size_t skip) {
  return WithQuery(shape, "Survivors", [&](const Scan& scan) {
    return Survivors(Scan(scan), indices, options, skip);
  });
}

std::size_t CountSurvivors(ShapeScan&& shape, const Options& options) {
  return WithQuery(shape, "CountSurvivors", [&](const Scan& scan) {
    return CountSurvivors(Scan(scan), options);
  });
}

std::size_t AnySurvivor(ShapeScan&& shape, const Options& options) {
  return WithQuery(shape, "AnySurvivor", [&](const Scan& scan) {
    return AnySurvivor(Scan(scan), options);
  });
}

void ForEachSurvivor(ShapeScan&& shape, SomeFunction function, void* context,
                     const Options& options) {
  WithQuery(shape, "ForEachSurvivor", [&](const Scan& scan) {
    ForEachSurvivor(Scan(scan), function, context, options);
  });
}

}  // namespace halfspace::detail
