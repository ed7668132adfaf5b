// Masks in the caller's memory.
#ifndef HALFSPACE_DISPATCH_ROWS_H_
#define HALFSPACE_DISPATCH_ROWS_H_

#include <cstddef>
#include <cstdint>

#include "dispatch/prepared_scan.h"

namespace halfspace::dispatch {

// Writes the masks of all queries: query q's is `words` words from
// rows + q * words on, of which those of the scan's range are written. Returns
// the bit of the target.
std::int64_t WriteRows(const PreparedScan& scan, std::uint64_t* rows,
                       std::size_t words, std::uint64_t flip);

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_ROWS_H_
