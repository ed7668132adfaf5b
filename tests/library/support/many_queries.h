// Many queries for the inputs of inputs.h.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_MANY_QUERIES_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_MANY_QUERIES_H_

#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <vector>

#include "tests/library/support/cases.h"
#include "tests/library/support/inputs.h"

namespace halfspace::testing {

// Queries around that of the input, as `Case` sees them. Half of their values
// are the input's own, so that all of them have survivors; the others are
// elsewhere, one ulp away, or special, so that no two answers are alike.
template <typename Case>
std::vector<typename Case::View::Query> MakeQueries(
    const Input<typename Case::Stored>& input, std::size_t count,
    Random& random) {
  using View = typename Case::View;
  using T = ScalarOf<View>;
  constexpr T kInfinity = std::numeric_limits<T>::infinity();
  std::uniform_real_distribution<T> shift(T{-40}, T{60});
  std::vector<typename View::Query> queries;
  for (std::size_t q = 0; q < count; ++q) {
    auto query = Case::Seen(input.query);
    for (std::size_t p = 0; p < kPlanes<View>; ++p) {
      T& value = OpposingValue<View>(query, p);
      switch (random() % 16) {
        case 0:
          value = SpecialValue<T>(random);
          break;
        case 1:
          value = std::nextafter(value, kInfinity);
          break;
        case 2:
          value = std::nextafter(value, -kInfinity);
          break;
        case 3:
        case 4:
        case 5:
        case 6:
        case 7:
          value += IsMinPlane<View>(p) ? shift(random) : -shift(random);
          break;
        default:
          break;
      }
    }
    queries.push_back(query);
  }
  return queries;
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_MANY_QUERIES_H_
