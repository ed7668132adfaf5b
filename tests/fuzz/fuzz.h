// The properties of tests on what a fuzzer chooses. Each fuzzer defines Fuzz().
#ifndef HALFSPACE_TESTS_FUZZ_FUZZ_H_
#define HALFSPACE_TESTS_FUZZ_FUZZ_H_

#include "tests/library/support/inputs.h"

namespace halfspace::testing {

void Fuzz(Random& random);

// One of a list.
template <typename List>
const auto& OneOf(const List& list, Random& random) {
  return list[random() % std::size(list)];
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_FUZZ_FUZZ_H_
