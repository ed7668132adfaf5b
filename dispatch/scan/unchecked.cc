#include "dispatch/scan/unchecked.h"

#include "dispatch/scan/chunks.h"
#include "halfspace/reject.h"

namespace halfspace::dispatch {

void WriteManyObjects(detail::Scan& scan, std::uint64_t* mask) {
  WriteWords(scan, Options(), mask);
}

void WriteEachQuery(detail::Scan& scan, std::uint64_t* masks) {
  ChooseKernel(scan, Options());
  // Floats and doubles are not encoded, so no room for it is needed.
  WriteRows<OneQuery>(scan, masks, MaskWords(scan.size));
}

}  // namespace halfspace::dispatch
