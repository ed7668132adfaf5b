// Damages files in the same ways on every machine.
#ifndef HALFSPACE_TESTS_TOOLS_MUTATIONS_H_
#define HALFSPACE_TESTS_TOOLS_MUTATIONS_H_

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <random>
#include <string>
#include <string_view>

#include "tests/tools/bad_file.h"
#include "tests/tools/temp_file.h"

namespace halfspace::bench {

class Mutator {
 public:
  explicit Mutator(std::string_view original) : original_(original) {}

  // The original after an edit or two, or cut short.
  std::string operator()() {
    std::string text = original_;
    if (Below(16) == 0) text.resize(Below(text.size()));
    for (std::size_t edits = 1 + Below(2); edits != 0; --edits) Edit(text);
    return text;
  }

 private:
  // Not std::uniform_int_distribution, which differs between libraries.
  std::size_t Below(std::size_t bound) { return random_() % bound; }

  void Edit(std::string& text) {
    const std::size_t at = Below(text.size() + 1);
    switch (Below(6)) {
      case 0:
        text.replace(at, 1, 1, static_cast<char>(Below(256)));
        break;
      case 1:
        text.replace(at, 1, 1, kTelling[Below(kTelling.size())]);
        break;
      case 2:
        text.insert(at, 1, kTelling[Below(kTelling.size())]);
        break;
      case 3:
        text.insert(at, 1, kTelling[Below(kDigits)]);
        break;
      case 4:
        text.erase(at, 1 + Below(4));
        break;
      default:
        Copy(text, at);
        break;
    }
  }

  void Copy(std::string& text, std::size_t to) {
    const std::size_t from = Below(text.size() + 1);
    const std::size_t length = Below(24);
    text.insert(to, text.substr(from, length));
  }

  // What readers give a meaning to, the digits first.
  static constexpr std::size_t kDigits = 10;
  static constexpr std::string_view kTelling =
      "0123456789+-.eEnaif/\\#,vf \t\r\n";

  std::string original_;
  std::mt19937 random_{20240229};
};

// Every damaged version of a good file is either refused with a well-formed
// message or passes `check`.
template <typename Read, typename Check>
void ExpectSafeOnMutations(std::string_view good, const Read& read,
                           const Check& check) {
  constexpr int kMutations = 8000;
  Mutator mutate(good);
  int refused = 0;
  for (int i = 0; i < kMutations; ++i) {
    const std::string text = mutate();
    const TempFile file(text);
    const std::optional<std::string> message = ErrorOf(
        [&](const std::string& path) { check(read(path)); }, file.path());
    if (message) {
      ++refused;
      ExpectWellFormed(*message, file.path());
    }
    if (testing::Test::HasFailure())
      FAIL() << "on mutation " << i << ":\n" << text;
  }
  // Else the mutations are too weak, or too strong, to show anything.
  EXPECT_GT(refused, kMutations / 10);
  EXPECT_LT(refused, kMutations - kMutations / 10);
}

}  // namespace halfspace::bench

#endif  // HALFSPACE_TESTS_TOOLS_MUTATIONS_H_
