// The bytes of an untrusted file. Memory grows with what has been read, never
// by what the file or the file system promises.
#ifndef HALFSPACE_BENCH_INPUT_INPUT_FILE_H_
#define HALFSPACE_BENCH_INPUT_INPUT_FILE_H_

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

// A whole text file. Stops at the first NUL, because a sparse file or a device
// must not fill the memory. Throws InputError.
std::string ReadText(const std::string& path);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_INPUT_INPUT_FILE_H_
