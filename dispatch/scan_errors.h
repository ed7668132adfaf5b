// What can be wrong with the arguments of a scan. Found without a branch per
// plane by dispatch/prepared_scan.cc; said here.
#ifndef HALFSPACE_DISPATCH_SCAN_ERRORS_H_
#define HALFSPACE_DISPATCH_SCAN_ERRORS_H_

#include <cstddef>
#include <string_view>

#include "halfspace/detail/scan.h"
#include "halfspace/reject.h"

namespace halfspace::dispatch {

// Each throws std::invalid_argument, in the name of `call`, if there is
// something to say; they are called where there may be.
void RefuseBadWorld(const detail::Scan& scan, std::string_view call);
void RefuseBadRange(const detail::Scan& scan, const Range& range,
                    std::string_view call);
void RefuseBadSchedule(Schedule schedule, std::string_view call);
void RefuseBadOutput(const detail::Scan& scan, std::string_view call,
                     std::string_view argument, const void* begin,
                     std::size_t bytes, std::size_t alignment);

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_SCAN_ERRORS_H_
