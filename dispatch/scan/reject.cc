#include "halfspace/reject.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "dispatch/scan/chunks.h"
#include "dispatch/scan/prepare.h"
#include "kernels/compiler.h"

namespace halfspace::detail {
namespace {

using dispatch::CallOutput;
using dispatch::OneQuery;
using dispatch::Tested;

// A function of its own, because its buffers would make the stack frame of its
// caller large.
HALFSPACE_NOINLINE void WriteQuantizedMask(const Scan& scan,
                                           std::uint64_t* mask) {
  dispatch::WriteRows<OneQuery>(scan, mask, 0);
}

// `flip` is 0, or all ones for a reject mask.
inline void WriteMask(Scan& scan, Span<std::uint64_t> mask,
                      const Options& options, const char* call,
                      std::uint64_t flip) {
  dispatch::Prepare(scan, options, call, [mask](std::size_t objects) {
    return CallOutput{"mask", mask.data(), mask.size(), MaskWords(objects),
                      sizeof(std::uint64_t)};
  });
  if (scan.type->encode != nullptr) {
    dispatch::ChooseKernel(scan, options);
    WriteQuantizedMask(scan, mask.data());
  } else {
    // Without chunks, a small call costs little more than its kernel.
    dispatch::WriteWords(scan, options, mask.data());
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
                      const Options& options, std::size_t skip) {
  // No more than one index for each object of the range is ever written.
  dispatch::Prepare(scan, options, "Survivors", [=](std::size_t objects) {
    return CallOutput{"indices",
                      indices.data(),
                      indices.size(),
                      std::min(indices.size(), objects),
                      sizeof(std::uint32_t),
                      true};
  });
  std::size_t count = 0;
  dispatch::VisitWords<OneQuery>(scan, options, [&](const Tested& tested) {
    std::size_t place = count;  // in a register
    dispatch::ForEachSurvivor(tested, [&](std::size_t, std::size_t object) {
      if (place >= skip && place - skip < indices.size()) {
        indices[place - skip] = static_cast<std::uint32_t>(object);
      }
      ++place;
    });
    count = place;
    return true;
  });
  return count;
}

void ForEachSurvivor(Scan&& scan, SomeFunction function, void* context,
                     const Options& options) {
  dispatch::Prepare(scan, options, "ForEachSurvivor", [](std::size_t) {
    return CallOutput{"indices", nullptr, 0, 0, sizeof(std::uint32_t), true};
  });
  std::array<std::uint32_t, 32> some;  // a call takes at most 8 KiB of stack
  std::size_t count = 0;
  bool goes_on = true;
  const auto pass = [&] {
    if (count != 0 && goes_on)
      goes_on = function(context, {some.data(), count});
    count = 0;
    return goes_on;
  };
  dispatch::VisitWords<OneQuery>(scan, options, [&](const Tested& tested) {
    dispatch::ForEachSurvivor(tested, [&](std::size_t, std::size_t object) {
      some[count++] = static_cast<std::uint32_t>(object);
      if (count == some.size()) pass();
    });
    return pass();
  });
}

std::size_t CountSurvivors(Scan&& scan, const Options& options) {
  dispatch::Prepare(scan, options, "CountSurvivors");
  std::size_t count = 0;
  dispatch::VisitWords<OneQuery>(scan, options, [&](const Tested& tested) {
    dispatch::ForEachCount(
        scan, tested,
        [&](std::size_t, std::size_t survivors) { count += survivors; });
    return true;
  });
  return count;
}

std::size_t AnySurvivor(Scan&& scan, const Options& options) {
  dispatch::Prepare(scan, options, "AnySurvivor");
  std::size_t first = kNoSurvivor;
  dispatch::VisitWords<dispatch::UrgentQuery>(
      scan, options, [&](const Tested& tested) {
        const std::uint64_t nonzero = tested.nonzero[0];
        if (nonzero == 0) return true;
        const auto w = static_cast<std::size_t>(std::countr_zero(nonzero));
        first =
            tested.chunk.begin + 64 * w +
            static_cast<std::size_t>(std::countr_zero(tested.chunk.rows[w]));
        return false;
      });
  return first;
}

}  // namespace halfspace::detail
