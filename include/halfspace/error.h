// What a call does if a precondition is violated.
//
// Each header lists the preconditions of its calls under "Errors". Examples of
// violations are an index past the end, a null pointer and a target that this
// machine does not have. By default such a call throws an Error.
//
// Set an error handler if the program is compiled without exceptions, or if
// errors should do something else, for example what an assertion of the engine
// does. A call then passes the Error to the handler and does not throw:
//
//   halfspace::SetErrorHandler([](const halfspace::Error& error) {
//     std::fprintf(stderr, "%s\n", error.what());
//     std::exit(1);
//   });
//
// A failed allocation is not a precondition violation. It throws std::bad_alloc
// and calls no handler.
//
// If the library itself is compiled without exceptions and no handler is set,
// it writes the message to stderr and calls std::abort. It also calls
// std::abort if a MemoryResource (memory.h) returns null.
#ifndef HALFSPACE_ERROR_H_
#define HALFSPACE_ERROR_H_

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

#include "halfspace/detail/cxx17.h"  // IWYU pragma: keep
#include "halfspace/export.h"

namespace halfspace {

// A violated precondition. what() is "halfspace: CALL: ARGUMENT: expected
// EXPECTED, got GIVEN". A program that has its own names for calls and
// arguments, such as a binding to another language, makes its message of the
// parts.
class HALFSPACE_API Error : public std::invalid_argument {
 public:
  static constexpr std::size_t kNoIndex = static_cast<std::size_t>(-1);

  Error(std::string_view call, std::string_view argument,
        std::string_view expected, std::string_view given,
        std::size_t index = kNoIndex);

  // For example "Bvh::Erase", "ids", "the id of an object" and "7". They are
  // parts of what(), and valid as long as what() is.
  std::string_view call() const { return {what() + kCall, call_}; }
  std::string_view argument() const { return {what() + Argument(), argument_}; }
  std::string_view expected() const { return {what() + Expected(), expected_}; }
  std::string_view given() const {
    return what() + Expected() + expected_ + sizeof(", got ") - 1;
  }
  // The element of `argument` that is wrong, or kNoIndex. what() has it in
  // brackets.
  std::size_t index() const { return index_; }

 private:
  // Where the parts begin in what().
  static constexpr std::size_t kCall = sizeof("halfspace: ") - 1;
  std::size_t Argument() const { return kCall + call_ + sizeof(": ") - 1; }
  std::size_t Expected() const {
    return Argument() + name_ + sizeof(": expected ") - 1;
  }

  // Their sizes. `name_` includes the index.
  std::size_t call_;
  std::size_t argument_;
  std::size_t name_;
  std::size_t expected_;
  std::size_t index_;
};

// The type of an error handler. `error` is valid until the handler ends.
//
// A handler must not return. If it returns, the library calls std::abort. A
// handler can end the program or throw any exception, but must not call
// longjmp. So a program without exceptions ends at an error: what can be wrong
// there must be checked before a call.
//
// The thread that made the wrong call runs the handler, before the call ends.
// At that time the call has written nothing, and the objects that it should
// have changed are unchanged. The call may hold a lock of them, so a handler
// must not use them. A handler runs in the default floating-point mode, or in
// the caller's.
using ErrorHandler = void (*)(const Error& error);

// Sets the error handler and returns the previous one. A null pointer is the
// default. The handler is used by all threads of the process, and by all of its
// modules that share this copy of the library.
//
// Thread safety: may be called from any thread at any time, and from a signal
// handler, because it is one atomic exchange. An error that is raised during
// the exchange is reported to one of the two handlers. After the exchange, the
// previous handler can still be running in another thread.
HALFSPACE_API ErrorHandler SetErrorHandler(ErrorHandler handler) noexcept;

namespace detail {

// The text of a number in a message: short, other for each number, and with a
// point in every locale.
std::string NumberText(float value);
std::string NumberText(double value);

}  // namespace detail
}  // namespace halfspace

#endif  // HALFSPACE_ERROR_H_
