// What survives the codes is tested on the floats.
#ifndef HALFSPACE_DISPATCH_CONFIRM_H_
#define HALFSPACE_DISPATCH_CONFIRM_H_

#include <cstddef>
#include <cstdint>

#include "halfspace/detail/scan.h"

namespace halfspace::dispatch {

// Clears the bits of those survivors among objects first ... that a plane of
// floats rejects. `first` is a multiple of 64, `query` one query of the scan.
void ConfirmWords(const detail::Scan& scan, const float* query,
                  std::size_t first, std::uint64_t* words, std::size_t count);

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_CONFIRM_H_
