// What survives the codes is tested on the floats.
#ifndef HALFSPACE_DISPATCH_CONFIRM_H_
#define HALFSPACE_DISPATCH_CONFIRM_H_

#include <cstddef>
#include <cstdint>

#include "halfspace/detail/scan.h"

namespace halfspace::dispatch {

// The survivors of one query among at most 4096 objects from `first` on, a
// multiple of 64: words, of which `live` are not 0.
struct Candidates {
  const float* query;
  std::size_t first;
  std::uint64_t* words;
  std::uint64_t live;
};

// Asks for the floats of the candidates, so that they are there a little later.
void PrefetchFloats(const detail::Scan& scan, const Candidates& candidates);

// Clears the bits of those that a plane of floats rejects.
void ConfirmWords(const detail::Scan& scan, const Candidates& candidates);

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_CONFIRM_H_
