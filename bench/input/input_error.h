// What is wrong with an input file, as one line for the user.
#ifndef HALFSPACE_BENCH_INPUT_INPUT_ERROR_H_
#define HALFSPACE_BENCH_INPUT_INPUT_ERROR_H_

#include <cstddef>
#include <stdexcept>
#include <string>

namespace halfspace::bench {

// what() is "FILE:LINE: problem; advice", or "FILE: problem; advice" where the
// file could not be read at all. The advice says what to do.
class InputError : public std::runtime_error {
 public:
  InputError(const std::string& file, const std::string& problem,
             const std::string& advice)
      : std::runtime_error(file + ": " + problem + "; " + advice) {}

  InputError(const std::string& file, std::size_t line,
             const std::string& problem, const std::string& advice)
      : InputError(file + ":" + std::to_string(line), problem, advice) {}
};

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_INPUT_INPUT_ERROR_H_
