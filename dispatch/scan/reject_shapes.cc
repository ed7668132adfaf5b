// The calls of reject_shapes.h. Half-spaces become the query of a scan, which
// the calls of reject.h run.
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
#include "kernels/compiler.h"
#include "kernels/scan/half_spaces.h"

namespace halfspace::detail {
namespace {

void MakeQuery(const ScanType& type, const float* half_spaces,
               std::size_t count, HalfSpaceQuery& query) {
  HalfSpaceTests& tests = query.tests;
  MakeHalfSpaceTests(type, half_spaces, count, tests);
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
  query.slack = std::numeric_limits<float>::infinity();
  if (tests.box_dims == 0) return;
  float most = 0;
  for (std::size_t k = 0; k < type.dims; ++k) {
    query.box[k] = tests.low[k];
    query.box[type.dims + k] = tests.high[k];
    most = std::max({most, std::abs(tests.low[k]), std::abs(tests.high[k])});
  }
  query.slack = kSumSlack * most + 0x1p-110f;
}

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
  HalfSpaceQuery query;
  dispatch::InDefaultFpMode(
      [&] { MakeQuery(type, half_spaces.values, half_spaces.count, query); });
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
