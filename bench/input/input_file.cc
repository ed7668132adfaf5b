#include "bench/input/input_file.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <string_view>
#include <system_error>

namespace halfspace::bench {
namespace {

constexpr std::size_t kChunk = std::size_t{1} << 16;

struct FileCloser {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, FileCloser>;

[[noreturn]] void FailToRead(const std::string& path, int error) {
  throw InputError(path,
                   "cannot be read: " + std::generic_category().message(error),
                   "give the path of a readable file");
}

[[noreturn]] void FailOnNul(const std::string& path, std::string_view text,
                            std::size_t nul) {
  // As TextLines counts.
  std::size_t line = 1;
  for (std::size_t i = 0; i < nul; ++i) {
    line += text[i] == '\n' || (text[i] == '\r' && text[i + 1] != '\n');
  }
  throw InputError(path, line, "a NUL byte, so this is no text file",
                   "give a plain text file");
}

File Open(const std::string& path) {
  File file(std::fopen(path.c_str(), "rb"));
  if (file == nullptr) FailToRead(path, errno);
  return file;
}

// Appends at most `most` bytes. False at the end of the file.
bool Append(const std::string& path, const File& file, std::size_t most,
            std::string& bytes) {
  const std::size_t size = bytes.size();
  bytes.resize(size + most);
  const std::size_t got = std::fread(bytes.data() + size, 1, most, file.get());
  if (std::ferror(file.get()) != 0) FailToRead(path, errno);
  bytes.resize(size + got);
  return got == most;
}

}  // namespace

std::string ReadText(const std::string& path) {
  const File file = Open(path);
  std::string text;
  bool is_more = true;
  while (is_more) {
    const std::size_t size = text.size();
    is_more = Append(path, file, kChunk, text);
    const std::size_t nul = text.find('\0', size);
    if (nul != std::string::npos) FailOnNul(path, text, nul);
  }
  return text;
}

}  // namespace halfspace::bench
