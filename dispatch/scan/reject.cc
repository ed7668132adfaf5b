#include "halfspace/reject.h"

#include <algorithm>
#include <bit>
#include <cstdint>

#include "dispatch/scan/parts.h"
#include "dispatch/scan/prepare.h"

namespace halfspace::detail {
namespace {

using dispatch::OneQuery;
using dispatch::Output;
using dispatch::Tested;

// A function of its own, because its buffers take stack, too.
[[gnu::noinline]] void WriteQuantizedMask(const Scan& scan,
                                          std::uint64_t* mask) {
  dispatch::WriteRows<OneQuery>(scan, mask, 0, false);
}

// `flip` is 0, or all ones for a reject mask.
inline void WriteMask(Scan& scan, Span<std::uint64_t> mask,
                      const Options& options, const char* call,
                      std::uint64_t flip) {
  dispatch::Prepare(scan, options, call, [mask](std::size_t objects) {
    return Output{"mask", mask.data(), mask.size(), MaskWords(objects),
                  sizeof(std::uint64_t)};
  });
  dispatch::ReportTarget(scan, options);
  if (scan.type->encode != nullptr) {
    dispatch::ChooseWay(scan, options);
    WriteQuantizedMask(scan, mask.data());
  } else if (dispatch::IsFlat(scan, options)) {
    dispatch::WriteFlatMask(scan, mask.data());
  } else {
    // Without parts: a small call costs little more than its kernel.
    dispatch::ChooseWay(scan, options);
    dispatch::Run(scan, dispatch::WholeRange(scan, mask.data()));
  }
  if (flip != 0) dispatch::Flip(mask.data(), MaskWords(scan.end - scan.begin));
}

}  // namespace

void SurvivorMask(Scan&& scan, Span<std::uint64_t> mask,
                  const Options& options) {
  WriteMask(scan, mask, options, "SurvivorMask", 0);
}

void RejectMask(Scan&& scan, Span<std::uint64_t> mask, const Options& options) {
  WriteMask(scan, mask, options, "RejectMask", ~std::uint64_t{0});
}

std::size_t Survivors(Scan&& scan, Span<std::uint32_t> indices,
                      const Options& options) {
  // No more than one index for each object of the range is ever written.
  dispatch::Prepare(scan, options, "Survivors", [=](std::size_t objects) {
    return Output{"indices",
                  indices.data(),
                  indices.size(),
                  std::min(indices.size(), objects),
                  sizeof(std::uint32_t),
                  true};
  });
  dispatch::ReportTarget(scan, options);
  std::size_t count = 0;
  const auto add = [&](std::size_t object) {
    const std::size_t place = count++;
    if (place >= options.skip && place - options.skip < indices.size()) {
      indices[place - options.skip] = static_cast<std::uint32_t>(object);
    }
  };
  if (dispatch::IsShort(scan)) {
    for (std::uint64_t left = dispatch::ShortWord(scan); left != 0;
         left &= left - 1) {
      add(scan.begin + static_cast<std::size_t>(std::countr_zero(left)));
    }
    return count;
  }
  dispatch::ChooseWay(scan, options);
  if (dispatch::OneRun run; dispatch::TestOneRun(scan, run)) {
    dispatch::ForEachBit(run.words, run.nonzero,
                         [&](std::size_t object) { add(scan.begin + object); });
    return count;
  }
  dispatch::ForEachPart<OneQuery>(scan, [&](const Tested& tested) {
    dispatch::ForEachSurvivor(
        scan, tested, [&](std::size_t, std::size_t object) { add(object); });
  });
  return count;
}

std::size_t CountSurvivors(Scan&& scan, const Options& options) {
  dispatch::Prepare(scan, options, "CountSurvivors");
  dispatch::ReportTarget(scan, options);
  if (dispatch::IsShort(scan)) {
    const std::uint64_t word = dispatch::ShortWord(scan);
    return scan.kernels->count_bits(&word, 1);
  }
  dispatch::ChooseWay(scan, options);
  if (dispatch::OneRun run; dispatch::TestOneRun(scan, run)) {
    return scan.kernels->count_bits(run.words, run.nonzero);
  }
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
  if (dispatch::IsShort(scan)) {
    const std::uint64_t word = dispatch::ShortWord(scan);
    if (word == 0) return kNoSurvivor;
    return scan.begin + static_cast<std::size_t>(std::countr_zero(word));
  }
  dispatch::ChooseWay(scan, options);
  dispatch::EncodedQueries<1> quantized;
  std::uint64_t words[dispatch::kRunWords];
  Tested tested;
  Part& part = tested.part;
  part = dispatch::WholeRange(scan, words);
  part.queries = dispatch::ReadableQueries(scan, 0, 1, quantized);
  part.end = scan.begin;
  // A survivor is often among the first.
  std::size_t objects = 512;
  while (part.end < scan.end) {
    part.begin = part.end;
    part.end += std::min(scan.end - part.begin, objects);
    dispatch::TestPart(scan, tested);
    if (scan.type->is_refined) {
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
