// Worlds and queries to test with: plane by plane, each value placed relative
// to the query's value that it will be compared with.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_INPUTS_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_INPUTS_H_

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <span>

#include "tests/library/support/cases.h"
#include "tests/library/support/special_values.h"

namespace halfspace::testing {

// Where tests draw from: numbers of a seed, or those that a fuzzer chooses. Two
// bytes choose a number, and all bytes choose the numbers past their end.
class Random {
 public:
  using result_type = std::uint64_t;
  static constexpr result_type min() { return 0; }
  static constexpr result_type max() { return ~result_type{0}; }

  explicit Random(std::uint64_t seed) : engine_(seed) {}
  explicit Random(std::span<const std::uint8_t> bytes) : bytes_(bytes) {
    std::uint64_t seed = 0;
    for (std::uint8_t byte : bytes) seed = (seed ^ byte) * 0x100000001b3u;
    engine_.seed(seed);
  }

  result_type operator()() {
    if (bytes_.size() < 2) return engine_();
    const result_type chosen = bytes_[0] | bytes_[1] << 8;
    bytes_ = bytes_.subspan(2);
    // An odd factor: each remainder of a small divisor can be chosen.
    return chosen * 0x9e3779b97f4a7c15u;
  }

 private:
  std::mt19937_64 engine_;
  std::span<const std::uint8_t> bytes_;
};

enum class InputKind {
  kDense,        // almost everything survives
  kMixed,        // every plane rejects a third
  kSparse,       // every plane rejects most
  kRuns,         // long runs of rejected objects, then of survivors
  kAdversarial,  // touching, one ulp apart, and special values, also inverted
  kRegions,      // of 5000 objects, each with its share of survivors
};

inline constexpr std::array kInputKinds = {InputKind::kDense, InputKind::kMixed,
                                           InputKind::kSparse, InputKind::kRuns,
                                           InputKind::kAdversarial};

inline const char* NameOf(InputKind kind) {
  constexpr std::array kNames = {"dense", "mixed",       "sparse",
                                 "runs",  "adversarial", "regions"};
  return kNames[static_cast<std::size_t>(kind)];
}

inline constexpr std::size_t kObjectsOfRegion = 5000;

inline bool OneIn(double n, Random& random) {
  return std::uniform_real_distribution<>(0.0, n)(random) < 1.0;
}

template <typename T>
T SpecialValue(Random& random) {
  return kSpecialValues<T>[random() % kSpecialValues<T>.size()];
}

// A value for a plane that is compared with `query`.
template <typename T>
class PlaneValueSource {
 public:
  PlaneValueSource(InputKind kind, bool is_min, T query)
      : kind_(kind), is_min_(is_min), query_(query) {}

  T Next(Random& random) {
    switch (kind_) {
      case InputKind::kDense:
        return Apart(OneIn(64, random), random);
      case InputKind::kMixed:
        return Apart(OneIn(3, random), random);
      case InputKind::kSparse:
        return Apart(!OneIn(4, random), random);
      case InputKind::kRuns:
        if (run_left_ == 0) {
          run_left_ = 1 + random() % 80;
          run_rejects_ = !run_rejects_;
        }
        --run_left_;
        return Apart(run_rejects_ != OneIn(200, random), random);
      case InputKind::kAdversarial:
        return Adversarial(random);
      case InputKind::kRegions: {
        // How many of the objects a plane rejects.
        constexpr double kOneIn[] = {1.01, 4, 2, 64, 1.01, 3, 1.01, 2, 4};
        const std::size_t region = count_++ / kObjectsOfRegion;
        return Apart(OneIn(kOneIn[region % 9], random), random);
      }
    }
    return query_;
  }

 private:
  T Apart(bool rejected, Random& random) const {
    std::uniform_real_distribution<T> distance(T{0.5}, T{100});
    const T away = distance(random);
    return query_ + (rejected == is_min_ ? away : -away);
  }

  T Adversarial(Random& random) const {
    constexpr T kInfinity = std::numeric_limits<T>::infinity();
    switch (random() % 8) {
      case 0:
      case 1:
        return query_;
      case 2:
        return std::nextafter(query_, kInfinity);
      case 3:
        return std::nextafter(query_, -kInfinity);
      case 4:
        return SpecialValue<T>(random);
      case 5:
        return -query_;
      default:
        return Apart(OneIn(8, random), random);
    }
  }

  InputKind kind_;
  bool is_min_;
  T query_;
  std::size_t count_ = 0;
  std::size_t run_left_ = 0;
  bool run_rejects_ = false;
};

// Fills a plane, and returns the query's value for it.
template <typename T>
T FillPlane(InputKind kind, bool is_min, std::span<T> plane, Random& random) {
  std::uniform_real_distribution<T> coordinate(T{-100}, T{100});
  const bool special = kind == InputKind::kAdversarial && OneIn(4, random);
  const T query = special ? SpecialValue<T>(random) : coordinate(random);
  PlaneValueSource<T> source(kind, is_min, query);
  for (T& value : plane) value = source.Next(random);
  return query;
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_INPUTS_H_
