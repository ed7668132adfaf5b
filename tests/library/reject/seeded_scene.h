// Objects and queries of each number of dimensions that are the same on every
// machine: half of them made by the builders, half of seeded values, among them
// special ones and those that touch.
#ifndef HALFSPACE_TESTS_LIBRARY_REJECT_SEEDED_SCENE_H_
#define HALFSPACE_TESTS_LIBRARY_REJECT_SEEDED_SCENE_H_

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "halfspace/bounds.h"
#include "tests/library/support/cases.h"
#include "tests/library/support/seeded_bounds.h"
#include "tests/library/support/seeded_numbers.h"
#include "tests/library/support/special_values.h"

namespace halfspace::testing {

// The planes of an octahedron, in floats or in doubles.
template <int kDims, typename T>
struct SeededPlanes {
  std::array<T, kDims + 1> min;
  std::array<T, kDims + 1> max;
};

template <int kDims, typename T>
struct SeededScene {
  // A tile of a staged scan, then words, then a tail.
  static constexpr std::size_t kObjects = 4096 + 3 * 64 + 37;
  static constexpr std::size_t kQueries = 32;

  using Bound = SeededPlanes<kDims, T>;

  std::vector<Bound> objects;
  std::vector<Bound> queries;

  SeededScene() {
    SeededNumbers numbers(kDims);
    while (queries.size() < kQueries) {
      queries.push_back(Next(numbers, queries));
    }
    while (objects.size() < kObjects) {
      objects.push_back(Next(numbers, queries));
    }
  }

 private:
  // Half of them by the builders.
  static Bound Next(SeededNumbers& numbers, std::span<const Bound> others) {
    if (numbers.Below(2) == 0) {
      const auto& builders = kSeededBuilders<kDims>;
      const auto one =
          numbers.Below(static_cast<std::uint32_t>(builders.size()));
      return Widened(builders[one].build(numbers));
    }
    Bound bound;
    for (std::size_t k = 0; k < bound.min.size(); ++k) {
      const auto* other = others.empty()
                              ? nullptr
                              : &others[numbers.Below(
                                    static_cast<std::uint32_t>(others.size()))];
      bound.min[k] = Value(numbers, -16, other ? other->max[k] : 0);
      bound.max[k] = Value(numbers, 16, other ? other->min[k] : 0);
    }
    return bound;
  }

  static Bound Widened(const Aabo<kDims>& bound) {
    Bound result;
    std::copy(bound.min.begin(), bound.min.end(), result.min.begin());
    std::copy(bound.max.begin(), bound.max.end(), result.max.begin());
    return result;
  }

  // Half of the values seldom reject, so that some objects survive. The others
  // are anything at all, touch an opposing value or are one ulp from it.
  static T Value(SeededNumbers& numbers, T loose, T opposing) {
    const auto bits = std::bit_cast<BitsOf<T>>(opposing);
    switch (numbers.Below(10)) {
      case 0:
        return numbers.Special<T>();
      case 1:
        return numbers.Raw<T>();
      case 2:
        return opposing;
      case 3:
        return std::bit_cast<T>(bits + 1);
      case 4:
        return std::bit_cast<T>(bits - 1);
      default:
        return loose;
    }
  }
};

template <typename Bound, int kDims, typename T>
Bound PartOf(const SeededPlanes<kDims, T>& planes) {
  Bound bound;
  for (std::size_t k = 0; k < Bound::kAxes; ++k) {
    if constexpr (HasMinima<Bound>) bound.min[k] = planes.min[k];
    if constexpr (HasMaxima<Bound>) bound.max[k] = planes.max[k];
  }
  return bound;
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_REJECT_SEEDED_SCENE_H_
