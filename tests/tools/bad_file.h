// What tests expect of readers that are given bad files.
#ifndef HALFSPACE_TESTS_TOOLS_BAD_FILE_H_
#define HALFSPACE_TESTS_TOOLS_BAD_FILE_H_

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>

#include "bench/input/text_lines.h"
#include "tests/tools/temp_file.h"

namespace halfspace::bench {

struct BadFile {
  const char* name;
  std::string content;
  std::size_t line;
  std::string_view problem;
};

inline void PrintTo(const BadFile& bad, std::ostream* out) { *out << bad.name; }

inline std::string NameOf(const testing::TestParamInfo<BadFile>& info) {
  return info.param.name;
}

// The message of the InputError that `read(path)` throws; nothing if it throws
// none. Any other exception fails the test.
template <typename Read>
std::optional<std::string> ErrorOf(const Read& read, const std::string& path) {
  try {
    read(path);
  } catch (const InputError& error) {
    return error.what();
  }
  return std::nullopt;
}

// One line that a terminal can show whatever the file holds, with the place
// first, and advice.
inline void ExpectWellFormed(const std::string& message,
                             const std::string& path) {
  EXPECT_EQ(message.find(path + ":"), 0u) << message;
  EXPECT_NE(message.find("; "), std::string::npos) << message;
  EXPECT_TRUE(std::all_of(message.begin(), message.end(), [](char c) {
    return c >= ' ' && c <= '~';
  })) << message;
}

template <typename Read>
void ExpectRejected(const Read& read, const BadFile& bad) {
  const TempFile file(bad.content);
  const std::optional<std::string> message = ErrorOf(read, file.path());
  ASSERT_TRUE(message.has_value()) << "was accepted";
  ExpectWellFormed(*message, file.path());
  std::string expected = file.path() + ":" + std::to_string(bad.line) + ": ";
  expected.append(bad.problem).append("; ");
  EXPECT_EQ(message->substr(0, expected.size()), expected) << *message;
}

// A path that cannot be read has no line to name.
template <typename Read>
void ExpectUnreadable(const Read& read, const std::string& path) {
  const std::optional<std::string> message = ErrorOf(read, path);
  ASSERT_TRUE(message.has_value()) << "was accepted";
  EXPECT_EQ(message->find(path + ": cannot be read: "), 0u) << *message;
  EXPECT_NE(message->find("; give the path of a readable file"),
            std::string::npos)
      << *message;
}

}  // namespace halfspace::bench

#endif  // HALFSPACE_TESTS_TOOLS_BAD_FILE_H_
