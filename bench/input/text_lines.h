// An untrusted text file: its bytes, its lines, and the numbers in them. Memory
// grows with what has been read, never by what the file or the file system
// promises. Every error names its place.
#ifndef HALFSPACE_BENCH_INPUT_TEXT_LINES_H_
#define HALFSPACE_BENCH_INPUT_TEXT_LINES_H_

#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

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

class TextLines {
 public:
  // The text of the file at `path`. Throws InputError if it is empty.
  TextLines(std::string path, std::string text);

  // Lines are views into the text.
  TextLines(const TextLines&) = delete;
  TextLines& operator=(const TextLines&) = delete;

  // The next line, without its end (LF, CR LF or CR); nothing after the last
  // one.
  std::optional<std::string_view> Next();

  // The number of the line that Next() returned last, from 1 on.
  std::size_t number() const { return number_; }

  // Throws InputError at the current line, or at `line`.
  [[noreturn]] void Fail(const std::string& problem,
                         const std::string& advice) const;
  [[noreturn]] void FailAt(std::size_t line, const std::string& problem,
                           const std::string& advice) const;

 private:
  std::string path_;
  std::string text_;
  std::string_view rest_;
  std::size_t number_ = 0;
};

// Whether a character separates fields within a line, or surrounds them.
constexpr bool IsBlank(char c) { return c == ' ' || c == '\t'; }

// `text` without blanks at its start.
std::string_view SkipBlanks(std::string_view text);

// A piece of an untrusted file that is safe to print: in quotes, shortened,
// control and non-ASCII characters as \xNN.
std::string Quoted(std::string_view text);

// The float nearest to the decimal number that `field`, from the current line
// of `lines`, is. Fails at that line if it is anything else, or infinite as a
// float.
float ParseFloat(const TextLines& lines, std::string_view field);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_INPUT_TEXT_LINES_H_
