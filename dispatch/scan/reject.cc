#include "halfspace/reject.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <string>

#include "dispatch/scan/parts.h"
#include "dispatch/scan/prepare.h"
#include "kernels/error.h"

namespace halfspace::detail {
namespace {

using dispatch::OneQuery;
using dispatch::Tested;

// A function of its own, because its strings take stack that every call would
// have to reserve.
[[noreturn]] void ThrowShortMask(const Scan& scan, std::size_t words) {
  const std::size_t objects = scan.end - scan.begin;
  kernels::ThrowInvalid(scan.call, "mask",
                        "at least " + std::to_string(MaskWords(objects)) +
                            " words for " + std::to_string(objects) +
                            " objects",
                        std::to_string(words));
}

// A function of its own, because its buffers take stack, too.
[[gnu::noinline]] void WriteQuantizedMask(const Scan& scan,
                                          std::uint64_t* mask) {
  dispatch::WriteRows<OneQuery>(scan, mask, 0, false);
}

inline void WriteMask(Scan& scan, Span<std::uint64_t> mask,
                      const Options& options, const char* call) {
  dispatch::Prepare(scan, options, call);
  const std::size_t words = MaskWords(scan.end - scan.begin);
  if (mask.size() < words) [[unlikely]] {
    ThrowShortMask(scan, mask.size());
  }
  dispatch::CheckOutput(scan,
                        {"mask", mask.data(), words * sizeof(std::uint64_t),
                         alignof(std::uint64_t)});
  dispatch::ReportTarget(scan, options);
  if (scan.quantizer != nullptr) return WriteQuantizedMask(scan, mask.data());
  // Without parts: a small call costs little more than its kernel.
  dispatch::Run(scan, {.first_query = 0,
                       .query_count = 1,
                       .queries = scan.queries,
                       .begin = scan.begin,
                       .end = scan.end,
                       .rows = mask.data(),
                       .stride = 0});
}

}  // namespace

void SurvivorMask(Scan&& scan, Span<std::uint64_t> mask,
                  const Options& options) {
  WriteMask(scan, mask, options, "SurvivorMask");
}

void RejectMask(Scan&& scan, Span<std::uint64_t> mask, const Options& options) {
  WriteMask(scan, mask, options, "RejectMask");
  dispatch::Flip(mask.data(), MaskWords(scan.end - scan.begin));
}

std::size_t Survivors(Scan&& scan, Span<std::uint32_t> indices,
                      const Options& options) {
  dispatch::Prepare(scan, options, "Survivors");
  dispatch::CheckIndicesFit(scan);
  // No more than one index for each object of the range is ever written.
  dispatch::CheckOutput(scan, {"indices", indices.data(),
                               std::min(indices.size(), scan.end - scan.begin) *
                                   sizeof(std::uint32_t),
                               alignof(std::uint32_t)});
  dispatch::ReportTarget(scan, options);
  std::size_t count = 0;
  dispatch::ForEachPart<OneQuery>(scan, [&](const Tested& tested) {
    dispatch::ForEachSurvivor(
        scan, tested, [&](std::size_t, std::size_t object) {
          if (count < indices.size()) {
            indices[count] = static_cast<std::uint32_t>(object);
          }
          ++count;
        });
  });
  return count;
}

std::size_t CountSurvivors(Scan&& scan, const Options& options) {
  dispatch::Prepare(scan, options, "CountSurvivors");
  dispatch::ReportTarget(scan, options);
  std::size_t count = 0;
  dispatch::ForEachPart<OneQuery>(scan, [&](const Tested& tested) {
    dispatch::ForEachCount(
        scan, tested,
        [&](std::size_t, std::size_t survivors) { count += survivors; });
  });
  return count;
}

std::size_t AnySurvivor(Scan&& scan, const Options& options) {
  dispatch::Prepare(scan, options, "AnySurvivor");
  dispatch::ReportTarget(scan, options);
  dispatch::EncodedQueries<1> quantized;
  std::uint64_t words[dispatch::kRunWords];
  Tested tested;
  Part& part = tested.part;
  part = {.first_query = 0,
          .query_count = 1,
          .queries = dispatch::ReadableQueries(scan, 0, 1, quantized),
          .begin = scan.begin,
          .end = scan.begin,
          .rows = words,
          .stride = 0};
  // A survivor is often among the first.
  std::size_t objects = 512;
  while (part.end < scan.end) {
    part.begin = part.end;
    part.end += std::min(scan.end - part.begin, objects);
    dispatch::TestPart(scan, tested);
    if (scan.is_refined) {
      dispatch::PrefetchCandidates(scan, tested);
      dispatch::Refine(scan, tested);
    }
    for (std::size_t w = 0; w < tested.words(); ++w) {
      if (words[w] != 0) {
        return part.begin + 64 * w +
               static_cast<std::size_t>(std::countr_zero(words[w]));
      }
    }
    objects = dispatch::kRunObjects;
  }
  return kNoSurvivor;
}

}  // namespace halfspace::detail
