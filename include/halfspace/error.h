// What a violated precondition does.
//
// The headers list under "Errors" what a call must not be given: an index past
// the end, a null pointer, a target that this machine does not have. By default
// such a call throws std::invalid_argument, whose what() says which call and
// which argument, what was expected and what was given. A program that wants
// something else, what an engine's assert does, or that is compiled without
// exceptions, sets a handler, which is called with the same text:
//
//   halfspace::SetErrorHandler([](const char* message) {
//     std::fprintf(stderr, "%s\n", message);
//     std::exit(1);
//   });
//
// The handler must not return; std::abort follows if it does. It may end the
// program, or throw what it likes, or, where the compiler lets C++ functions be
// left so (gcc and clang do), call longjmp, past functions of the library whose
// strings of the message are then never freed.
//
// It is called by the thread that made the call and before the call returns.
// The call has written nothing then, and what it was to change is as it was; no
// lock is held; the floating-point mode is the caller's. So it may itself call
// the library, and is called again if that call is wrong too.
//
// Where the library itself was compiled without exceptions, a message for which
// there is no handler goes to stderr, and std::abort follows, as it does where
// a MemoryResource (memory.h) has no memory.
//
// Memory that cannot be had is no violated precondition: std::bad_alloc is
// thrown, as by any operator new, and no handler is told.
#ifndef HALFSPACE_ERROR_H_
#define HALFSPACE_ERROR_H_

#include "halfspace/export.h"

namespace halfspace {

// `message` is valid until the handler is left.
using ErrorHandler = void (*)(const char* message);

// Sets the handler of the process, of all threads (of what shares this copy of
// the library), and returns the one there was. A null pointer is the default.
//
// Thread safety: may be called from any thread at any time, and from a signal
// handler: it is one atomic exchange. A call that goes wrong meanwhile is told
// to one of the two handlers, and the old one may still be running in another
// thread afterwards.
HALFSPACE_API ErrorHandler SetErrorHandler(ErrorHandler handler) noexcept;

}  // namespace halfspace

#endif  // HALFSPACE_ERROR_H_
