// The message of a violated precondition: which argument, what was expected,
// what was given.
#ifndef HALFSPACE_DISPATCH_ERRORS_ERROR_H_
#define HALFSPACE_DISPATCH_ERRORS_ERROR_H_

#include <string_view>

namespace halfspace::dispatch {

// Throws std::invalid_argument("halfspace: CALL: ARGUMENT: expected EXPECTED,
// got GIVEN"), or tells that to the program's handler (halfspace/error.h),
// which may leave without a destructor being called.
[[noreturn, gnu::cold]] void ThrowInvalid(std::string_view call,
                                          std::string_view argument,
                                          std::string_view expected,
                                          std::string_view given);

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_ERRORS_ERROR_H_
