// The first steps of every call: it checks its arguments and chooses how to
// scan.
#ifndef HALFSPACE_DISPATCH_SCAN_PREPARE_H_
#define HALFSPACE_DISPATCH_SCAN_PREPARE_H_

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>

#include "dispatch/targets/chosen_target.h"
#include "dispatch/targets/detect_targets.h"
#include "halfspace/detail/scan.h"
#include "halfspace/reject.h"
#include "kernels/scan/kernel_table.h"

namespace halfspace::detail {

struct HalfSpaceQuery;

// Called in the default floating-point mode.
void MakeHalfSpaceQuery(const PlaneLayout& layout, const ShapeScan& shape,
                        HalfSpaceQuery& query);

}  // namespace halfspace::detail

namespace halfspace::dispatch {

inline constexpr auto kLastSchedule =
    static_cast<std::size_t>(Schedule::kStagedByAxis);

// Up to so many bytes of planes count as in cache. More are streamed, on
// machines where that is faster.
inline constexpr std::size_t kInCacheBytes = 128 * 1024;

// Up to so many bytes of planes may be in the last cache of a server, of which
// a thread has a share of about this size. More count as in memory.
inline constexpr std::size_t kInAnyCacheBytes = std::size_t{32} << 20;

// Planes of no more values fit the address space whatever they store.
inline constexpr std::size_t kMostAddressable =
    std::numeric_limits<std::size_t>::max() / 16;

// Objects and queries that 32-bit indices can name.
inline constexpr std::uint64_t kMostIndices = std::uint64_t{1} << 32;

// The output of a call: `used` elements of `bytes` each. If `used` is 0, it is
// not checked.
struct CallOutput {
  const char* argument;
  const void* begin;
  std::size_t size;
  std::size_t used;
  std::size_t bytes;         // also their alignment
  bool are_indices = false;  // 32 bits
};

inline const void* PlaneAt(const detail::Scan& scan, std::size_t p) {
  const void* plane;
  std::memcpy(&plane, static_cast<const char*>(scan.planes) + p * sizeof(plane),
              sizeof(plane));
  return plane;
}

// The index of the target that runs. Throws (error.h), in the name of
// scan.call, if something is wrong.
std::size_t CheckEach(const detail::Scan& scan, const Options& options,
                      const CallOutput& output);
void CheckOutput(const detail::Scan& scan, const CallOutput& output);

// The kernel for all planes, by bound type and schedule. docs/design.md
// explains the defaults.
inline constexpr detail::ScanKernel kKernelOf[4][4] = {
    // kAuto, kFlat, kStaged, kStagedByAxis
    {detail::kMinima, detail::kMinima, detail::kMinima, detail::kMinima},
    {detail::kAdaptive, detail::kAll, detail::kByHalf, detail::kByAxis},
    {detail::kAdaptive, detail::kAll, detail::kBySimplex, detail::kByAxis},
    {detail::kMinima, detail::kMinima, detail::kMinima, detail::kMinima},
};
// A word of quantized bounds is only one or two vectors, so a stage by axis
// could not skip anything.
inline constexpr detail::ScanKernel kQuantizedKernelOf[3][4] = {
    {detail::kMinima, detail::kMinima, detail::kMinima, detail::kMinima},
    {detail::kAll, detail::kAll, detail::kAll, detail::kAll},
    {detail::kBySimplex, detail::kAll, detail::kBySimplex, detail::kBySimplex},
};

// The kernel of one query over planes that are not in cache.
inline constexpr detail::ScanKernel kStreamingKernelOf[detail::kScanKernels] = {
    detail::kMinimaStreaming, detail::kMinimaStreaming, detail::kAllStreaming,
    detail::kAllStreaming,    detail::kByAxis,          detail::kByHalf,
    detail::kBySimplex,       detail::kAdaptive,
};

// All objects of a scan for one query, unless its bounds are quantized.
inline detail::Chunk WholeRange(const detail::Scan& scan,
                                std::uint64_t* words) {
  return {.first_query = 0,
          .query_count = 1,
          .queries = scan.queries,
          .begin = scan.begin,
          .end = scan.end,
          .rows = words,
          .stride = 0};
}

// Writes the words of a chunk. Returns the bit of the target.
inline std::int64_t Run(const detail::Scan& scan, const detail::Chunk& chunk) {
  return scan.kernels->run[scan.kernel](scan, chunk);
}

// Whether an output is null or misaligned, or may overlap a plane or a query.
// Usually all planes are in one block of memory and the output is outside of
// it, so one compare is enough. Differences wrap.
inline bool IsSuspect(const detail::Scan& scan, const CallOutput& output) {
  const std::size_t bytes = output.used * output.bytes;
  const auto begin = reinterpret_cast<std::uintptr_t>(output.begin);
  const auto queries = reinterpret_cast<std::uintptr_t>(scan.queries);
  if (output.are_indices && std::uint64_t{scan.size} > kMostIndices)
    return true;
  return bytes != 0 &&
         (output.size < output.used || begin == 0 ||
          (begin & (output.bytes - 1)) != 0 ||
          begin - scan.addresses.lowest <
              scan.addresses.highest - scan.addresses.lowest +
                  scan.size * scan.type->element_bytes ||
          scan.addresses.lowest - begin < bytes ||
          begin - queries < scan.query_count * scan.type->query_record_bytes ||
          queries - begin < bytes);
}

// Throws (error.h) in the name of `call`. output(objects) returns the output of
// the call for a range of so many objects. The target is resolved for an empty
// world too, so that a bad target is always an error.
template <typename OutputOf>
inline void Prepare(detail::Scan& scan, const Options& options,
                    const char* call, const OutputOf& output_of) {
  const detail::ScanType& type = *scan.type;
  const Range& range = options.range;
  scan.call = call;
  scan.begin = std::min(range.begin, scan.size);
  scan.end = std::min(range.end, scan.size);
  const CallOutput output = output_of(scan.end - scan.begin);
  const auto queries = reinterpret_cast<std::uintptr_t>(scan.queries);
  const auto schedule = static_cast<std::size_t>(options.schedule);
  std::size_t target = KnownIndexOf(options.target);
  // A check of a few cycles finds out whether anything can be wrong. Only then
  // is each plane checked. Refined scans have planes of floats too, so they are
  // always checked.
  if (queries == 0 || (queries & (type.query_bytes - 1u)) != 0 ||
      scan.addresses.lowest == 0 ||
      (scan.addresses.bits & (type.element_bytes - 1u)) != 0 ||
      scan.size > kMostAddressable || type.is_refined ||
      range.begin > range.end || schedule > kLastSchedule ||
      target == kUnknownTarget || IsSuspect(scan, output)) [[unlikely]] {
    target = CheckEach(scan, options, output_of(scan.end - scan.begin));
  }
  scan.kernels = *type.all_kernels + target;
  scan.is_wide = WideVectorsPay();
}
inline void Prepare(detail::Scan& scan, const Options& options,
                    const char* call) {
  Prepare(scan, options, call, [](std::size_t) { return CallOutput{}; });
}

// Chooses how a prepared scan that is not short goes through its planes.
inline void ChooseKernel(detail::Scan& scan, const Options& options) {
  const detail::ScanType& type = *scan.type;
  scan.kernel =
      (type.encode == nullptr
           ? kKernelOf
           : kQuantizedKernelOf)[type.kind]
                                [static_cast<std::size_t>(options.schedule)];
  const std::size_t bytes = (scan.end - scan.begin) * type.record_bytes;
  scan.is_streaming =
      bytes > kInCacheBytes && scan.query_count == 1 && IsStreamingFaster();
  scan.is_in_memory = bytes > kInAnyCacheBytes && scan.query_count == 1;
  if (scan.is_streaming) scan.kernel = kStreamingKernelOf[scan.kernel];
}

// Writes the words of one query on the objects of the range by a MaskKernel.
// Not for quantized bounds.
inline void WriteFewWords(const detail::Scan& scan, std::uint64_t* words) {
  const auto& masks = scan.type->flat == detail::kMinima
                          ? scan.kernels->mask_of_minima
                          : scan.kernels->mask_of_all;
  masks[scan.is_wide](scan.planes, scan.begin, scan.end - scan.begin,
                      scan.queries, words);
}

// The most objects of kAuto that a MaskKernel tests. Simplices in cache have no
// other way.
inline std::size_t FewObjects(const detail::PlaneLayout& layout,
                              std::size_t element_bytes,
                              const detail::TargetKernels& kernels) {
  if (!layout.has_max)
    return kInCacheBytes / (layout.plane_count * element_bytes);
  return layout.kind == detail::PlaneLayout::kAabo ? kernels.few_octahedra
                                                   : kernels.few_objects;
}

// Writes the words of one query on any number of objects. Many objects are
// tested as the schedule says.
inline void WriteWords(detail::Scan& scan, const Options& options,
                       std::uint64_t* words) {
  const std::size_t objects = scan.end - scan.begin;
  if (objects < 64 ||
      (options.schedule == Schedule::kAuto &&
       objects <=
           FewObjects(*scan.type, scan.type->element_bytes, *scan.kernels))) {
    WriteFewWords(scan, words);
  } else {
    ChooseKernel(scan, options);
    Run(scan, WholeRange(scan, words));
  }
}

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_SCAN_PREPARE_H_
