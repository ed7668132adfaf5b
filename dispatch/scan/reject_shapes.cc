// The calls of reject_shapes.h: half-spaces become the query of a scan, and the
// calls of reject.h do the rest.
#include "halfspace/reject_shapes.h"

#include <cstddef>
#include <cstdint>
#include <string>

#include "kernels/error.h"
#include "kernels/exact/default_fp_mode.h"
#include "kernels/memory_checks.h"
#include "kernels/scan/fronts.h"

namespace halfspace::detail {
namespace {

// Points a scan to half-spaces. Both must have the same life.
class FrontScan {
 public:
  [[gnu::noinline]] FrontScan(Scan& scan, const HalfSpaceList& half_spaces,
                              const char* call)
      : type_(*scan.type) {
    if (half_spaces.count > kMostHalfSpaces) {
      kernels::ThrowInvalid(call, "half-spaces",
                            "at most " + std::to_string(kMostHalfSpaces),
                            std::to_string(half_spaces.count));
    }
    kernels::CheckMemory(call, "half-spaces", half_spaces.values,
                         half_spaces.count, alignof(float));
    const std::size_t dims =
        type_.shape == Shape::kAabb ? type_.axes : type_.axes - 1u;
    const ShapePlanes planes = {dims, type_.axes,
                                type_.shape != Shape::kSimplex};
    kernels::InDefaultFpMode([&] {
      query_.count = half_spaces.count;
      for (std::size_t f = 0; f < query_.count; ++f) {
        const float* const normal = half_spaces.values + f * (dims + 1);
        query_.front[f] = MakeFront(planes, normal, normal[dims]);
      }
    });
    type_.all_kernels = &kFrontKernels;
    scan.type = &type_;
    scan.queries = &query_;
    scan.query_count = 1;
  }

 private:
  ScanType type_;
  Fronts query_;
};

}  // namespace

void FrontMask(Scan&& scan, const HalfSpaceList& half_spaces,
               Span<std::uint64_t> mask, const Options& options) {
  const FrontScan fronts(scan, half_spaces, "SurvivorMask");
  SurvivorMask(Scan(scan), mask, options);
}

std::size_t FrontSurvivors(Scan&& scan, const HalfSpaceList& half_spaces,
                           Span<std::uint32_t> indices,
                           const Options& options) {
  const FrontScan fronts(scan, half_spaces, "Survivors");
  return Survivors(Scan(scan), indices, options);
}

std::size_t FrontCount(Scan&& scan, const HalfSpaceList& half_spaces,
                       const Options& options) {
  const FrontScan fronts(scan, half_spaces, "CountSurvivors");
  return CountSurvivors(Scan(scan), options);
}

std::size_t FrontAny(Scan&& scan, const HalfSpaceList& half_spaces,
                     const Options& options) {
  const FrontScan fronts(scan, half_spaces, "AnySurvivor");
  return AnySurvivor(Scan(scan), options);
}

}  // namespace halfspace::detail
