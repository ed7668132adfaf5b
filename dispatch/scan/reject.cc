#include "halfspace/reject.h"

#include <algorithm>
#include <array>
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

// Calls visit(object) for the survivors of a prepared scan, in ascending order,
// and end() after each part that it tested, until that returns false.
template <typename Visit, typename End>
void VisitSurvivors(Scan& scan, const Options& options, const Visit& visit,
                    const End& end) {
  if (dispatch::IsShort(scan)) {
    for (std::uint64_t left = dispatch::ShortWord(scan); left != 0;
         left &= left - 1) {
      visit(scan.begin + static_cast<std::size_t>(std::countr_zero(left)));
    }
    end();
    return;
  }
  dispatch::ChooseWay(scan, options);
  if (dispatch::OneRun run; dispatch::TestOneRun(scan, run)) {
    dispatch::ForEachBit(run.words, run.nonzero, [&](std::size_t object) {
      visit(scan.begin + object);
    });
    end();
    return;
  }
  dispatch::ForEachPart<OneQuery>(scan, [&](const Tested& tested) {
    dispatch::ForEachSurvivor(
        scan, tested, [&](std::size_t, std::size_t object) { visit(object); });
    return end();
  });
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
                      const Options& options, std::size_t skip) {
  // No more than one index for each object of the range is ever written.
  dispatch::Prepare(scan, options, "Survivors", [=](std::size_t objects) {
    return Output{"indices",
                  indices.data(),
                  indices.size(),
                  std::min(indices.size(), objects),
                  sizeof(std::uint32_t),
                  true};
  });
  std::size_t count = 0;
  VisitSurvivors(
      scan, options,
      [&](std::size_t object) {
        const std::size_t place = count++;
        if (place >= skip && place - skip < indices.size()) {
          indices[place - skip] = static_cast<std::uint32_t>(object);
        }
      },
      [] { return true; });
  return count;
}

void ForEachSurvivor(Scan&& scan, SomeFunction function, void* context,
                     const Options& options) {
  dispatch::Prepare(scan, options, "ForEachSurvivor", [](std::size_t) {
    return Output{"indices", nullptr, 0, 0, sizeof(std::uint32_t), true};
  });
  std::array<std::uint32_t, 256> some;  // of stack, as the header says
  std::size_t count = 0;
  bool goes_on = true;
  const auto pass = [&] {
    if (count != 0 && goes_on)
      goes_on = function(context, {some.data(), count});
    count = 0;
    return goes_on;
  };
  VisitSurvivors(
      scan, options,
      [&](std::size_t object) {
        some[count++] = static_cast<std::uint32_t>(object);
        if (count == some.size()) pass();
      },
      pass);
}

std::size_t CountSurvivors(Scan&& scan, const Options& options) {
  dispatch::Prepare(scan, options, "CountSurvivors");
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
