#include "halfspace/reject.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>

#include "dispatch/kernel_table.h"
#include "dispatch/registry.h"
#include "kernels/error.h"
#include "kernels/memory_checks.h"

namespace halfspace::detail {
namespace {

using dispatch::KernelsFor;
using kernels::CheckPointer;
using kernels::Overlap;
using kernels::ThrowInvalid;

std::size_t PlanesOf(const Scan& scan) {
  const auto dims = static_cast<std::size_t>(scan.dims);
  switch (scan.shape) {
    case Shape::kSimplex:
      return dims + 1;
    case Shape::kAabb:
      return 2 * dims;
    case Shape::kAabo:
      return 2 * (dims + 1);
  }
  return 0;
}

std::string PlaneName(const Scan& scan, std::size_t p) {
  const auto dims = static_cast<std::size_t>(scan.dims);
  const std::size_t axes = scan.shape == Shape::kAabb ? dims : dims + 1;
  std::string name = "world.";
  name += p < axes ? "min[" : "max[";
  return name + std::to_string(p % axes) + "]";
}

void CheckWorld(const Scan& scan, std::string_view call) {
  if (scan.size > std::numeric_limits<std::size_t>::max() / sizeof(float)) {
    ThrowInvalid(call, "world.size", "a size that fits the address space",
                 std::to_string(scan.size));
  }
  for (std::size_t p = 0; p < PlanesOf(scan); ++p) {
    CheckPointer(
        call, scan.planes[p], alignof(float),
        [&] { return PlaneName(scan, p); },
        [&] { return "a plane of " + std::to_string(scan.size) + " floats"; });
  }
}

// `bytes` of output from `begin` must lie outside every plane.
void CheckOutput(const Scan& scan, std::string_view call,
                 std::string_view argument, const void* begin,
                 std::size_t bytes, std::size_t alignment) {
  CheckPointer(
      call, begin, alignment, [&] { return argument; },
      [] { return "room for the output"; });
  for (std::size_t p = 0; p < PlanesOf(scan); ++p) {
    if (Overlap(scan.planes[p], scan.size * sizeof(float), begin, bytes)) {
      ThrowInvalid(call, argument, "memory apart from the world's planes",
                   "an overlap with " + PlaneName(scan, p));
    }
  }
}

dispatch::Variant VariantOf(const Scan& scan, Schedule schedule,
                            std::string_view call) {
  // The measured defaults; docs/design.md says why.
  if (schedule == Schedule::kAuto) {
    schedule = scan.shape == Shape::kAabo ? Schedule::kStaged : Schedule::kFlat;
  }
  if (schedule > Schedule::kStagedByAxis) {
    ThrowInvalid(call, "options.schedule", "one of the enumerators",
                 std::to_string(static_cast<int>(schedule)));
  }
  const bool flat = schedule == Schedule::kFlat;
  switch (scan.shape) {
    case Shape::kSimplex:
      return flat ? dispatch::kSimplexFlat : dispatch::kSimplexByAxis;
    case Shape::kAabb:
      return flat ? dispatch::kAabbFlat : dispatch::kAabbByAxis;
    case Shape::kAabo:
      break;
  }
  if (flat) return dispatch::kAaboFlat;
  return schedule == Schedule::kStaged ? dispatch::kAaboBySimplex
                                       : dispatch::kAaboByAxis;
}

// Everything that does not depend on the output. An empty world resolves its
// target too, so that a bad one is an error whatever the size.
const dispatch::Kernels& Prepare(const Scan& scan, const Options& options,
                                 std::string_view call) {
  if (scan.size != 0) CheckWorld(scan, call);
  return KernelsFor(options.target, scan.dims,
                    call)[VariantOf(scan, options.schedule, call)];
}

Target WriteMask(const Scan& scan, std::span<std::uint64_t> mask,
                 std::uint64_t flip, const Options& options,
                 std::string_view call) {
  const dispatch::Kernels& kernels = Prepare(scan, options, call);
  const std::size_t words = MaskWords(scan.size);
  if (words != 0) {
    if (mask.size() < words) {
      ThrowInvalid(call, "mask",
                   "at least " + std::to_string(words) + " words for " +
                       std::to_string(scan.size) + " objects",
                   std::to_string(mask.size()));
    }
    CheckOutput(scan, call, "mask", mask.data(), words * sizeof(std::uint64_t),
                alignof(std::uint64_t));
  }
  return Target::FromHighwayBit(kernels.mask(
      scan.planes.data(), scan.query.data(), scan.size, mask.data(), flip));
}

}  // namespace

Target RejectMask(const Scan& scan, std::span<std::uint64_t> mask,
                  const Options& options) {
  return WriteMask(scan, mask, 0, options, "RejectMask");
}

Target SurvivorMask(const Scan& scan, std::span<std::uint64_t> mask,
                    const Options& options) {
  return WriteMask(scan, mask, ~std::uint64_t{0}, options, "SurvivorMask");
}

SurvivorCount Survivors(const Scan& scan, std::span<std::uint32_t> indices,
                        const Options& options) {
  constexpr std::uint64_t kMostObjects = std::uint64_t{1} << 32;
  const dispatch::Kernels& kernels = Prepare(scan, options, "Survivors");
  if (scan.size > kMostObjects) {
    ThrowInvalid("Survivors", "world.size",
                 "at most 2^32 objects for 32-bit indices",
                 std::to_string(scan.size));
  }
  // No more than one index for each object is ever written.
  const std::size_t writable = std::min(indices.size(), scan.size);
  if (writable != 0) {
    CheckOutput(scan, "Survivors", "indices", indices.data(),
                writable * sizeof(std::uint32_t), alignof(std::uint32_t));
  }
  const dispatch::Counted counted =
      kernels.indices(scan.planes.data(), scan.query.data(), scan.size,
                      indices.data(), indices.size());
  return {counted.count, Target::FromHighwayBit(counted.target)};
}

SurvivorCount CountSurvivors(const Scan& scan, const Options& options) {
  const dispatch::Counted counted =
      Prepare(scan, options, "CountSurvivors")
          .count(scan.planes.data(), scan.query.data(), scan.size);
  return {counted.count, Target::FromHighwayBit(counted.target)};
}

SurvivorFlag AnySurvivor(const Scan& scan, const Options& options) {
  const dispatch::Counted counted =
      Prepare(scan, options, "AnySurvivor")
          .any(scan.planes.data(), scan.query.data(), scan.size);
  return {counted.count != 0, Target::FromHighwayBit(counted.target)};
}

}  // namespace halfspace::detail
