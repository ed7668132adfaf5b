// Random shapes whose bounds are hard to round, for the rows of builders.h.
#ifndef HALFSPACE_TESTS_LIBRARY_FIT_RANDOM_SHAPES_H_
#define HALFSPACE_TESTS_LIBRARY_FIT_RANDOM_SHAPES_H_

#include <gmpxx.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <span>
#include <utility>

#include "halfspace/fit.h"
#include "tests/library/fit/builders.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/inputs.h"

namespace halfspace::testing {

enum class PointKind {
  kUniform,
  kWideExponents,
  kSubnormal,
  kPowersOfTwo,
  kCancelling,
  kTies,  // sums on or right beside the middle between two floats or doubles
};

inline constexpr std::array kPointKinds = {
    PointKind::kUniform,     PointKind::kWideExponents, PointKind::kSubnormal,
    PointKind::kPowersOfTwo, PointKind::kCancelling,    PointKind::kTies};

inline const char* NameOf(PointKind kind) {
  constexpr std::array kNames = {"uniform",       "wide exponents", "subnormal",
                                 "powers of two", "cancelling",     "ties"};
  return kNames[static_cast<std::size_t>(kind)];
}

// Runs check(kind, random) for Scaled(samples) samples of each kind, or until
// one fails.
template <typename Check>
void ForEachSample(std::uint64_t seed, std::size_t samples, Check check) {
  Random random(seed);
  const std::size_t count = Scaled(samples);
  for (PointKind kind : kPointKinds) {
    for (std::size_t i = 0; i < count; ++i) {
      check(kind, random);
      if (::testing::Test::HasFailure()) {
        GTEST_FAIL() << NameOf(kind) << ", sample " << i;
      }
    }
  }
}

inline float RandomSign(Random& random) {
  return OneIn(2, random) ? -1.f : 1.f;
}

inline int RandomExponent(int least, int most, Random& random) {
  return std::uniform_int_distribution(least, most)(random);
}

// In [1, 2), all bits random.
inline float RandomMantissa(Random& random) {
  return std::bit_cast<float>(0x3f800000u |
                              static_cast<std::uint32_t>(random() >> 41));
}

// All magnitudes stay below 2^122, so that no sum leaves what can be bounded.
template <typename Scalar>
void RandomFloats(PointKind kind, Random& random, std::span<Scalar> point) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (std::size_t k = 0; k < point.size(); ++k) {
    const float sign = RandomSign(random);
    switch (kind) {
      case PointKind::kUniform:
        point[k] = std::uniform_real_distribution(-100.f, 100.f)(random);
        break;
      case PointKind::kWideExponents:
        point[k] = sign * std::ldexp(RandomMantissa(random),
                                     RandomExponent(-149, 120, random));
        break;
      case PointKind::kSubnormal:
        point[k] = sign * std::bit_cast<float>(
                              static_cast<std::uint32_t>(random() >> 41));
        break;
      case PointKind::kPowersOfTwo:
        point[k] = std::ldexp(sign, RandomExponent(-70, 20, random));
        break;
      case PointKind::kCancelling:
        // Each coordinate undoes the one before it, but for a few ulps.
        if (k % 2 == 0) {
          point[k] = sign * std::ldexp(RandomMantissa(random),
                                       RandomExponent(-60, 60, random));
        } else {
          auto value = static_cast<float>(-point[k - 1]);
          for (std::uint64_t n = random() % 3; n > 0; --n) {
            value = std::nextafter(value, sign * kInfinity);
          }
          point[k] = value;
        }
        break;
      case PointKind::kTies: {
        constexpr int kExponents[] = {0, 1, -23, -24, -25, -52, -53, -54, -149};
        float value = std::ldexp(sign, kExponents[random() % 9]);
        if (OneIn(4, random)) {
          value = std::nextafter(value, RandomSign(random) * kInfinity);
        }
        point[k] = value;
        break;
      }
    }
  }
}

// A double near `value` that uses more bits than a float has, sometimes all.
inline double WithMoreBits(float value, Random& random) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  constexpr std::uint64_t kBitsOfDoublesAlone = (std::uint64_t{1} << 29) - 1;
  switch (random() % 4) {
    case 0:
      return value;
    case 1:
      return std::nextafter(value, RandomSign(random) * kInfinity);
    default:
      return std::bit_cast<double>(std::bit_cast<std::uint64_t>(double{value}) |
                                   (random() & kBitsOfDoublesAlone));
  }
}

// Random numbers of floats or of doubles.
class RandomNumbers {
 public:
  RandomNumbers(PointKind kind, bool is_double, Random& random)
      : kind_(kind), is_double_(is_double), random_(&random) {}

  void FillPoint(std::span<double> point) const {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    RandomFloats(kind_, *random_, point);
    if (!is_double_) return;
    for (std::size_t k = 0; k < point.size(); ++k) {
      point[k] = WithMoreBits(static_cast<float>(point[k]), *random_);
      if (kind_ == PointKind::kSubnormal && OneIn(2, *random_)) {
        point[k] = std::ldexp(point[k], -RandomExponent(0, 920, *random_));
      }
      if (kind_ == PointKind::kCancelling && k % 2 == 1) {
        point[k] = -point[k - 1];
        if (OneIn(2, *random_)) point[k] = std::nextafter(point[k], kInfinity);
      }
    }
  }

  // Not negative; 0 now and then.
  double Length() const {
    if (OneIn(8, *random_)) return 0;
    double length = 0;
    FillPoint({&length, 1});
    return std::fabs(length);
  }

  // To multiply coordinates with: small enough for the largest of them.
  double Factor() const {
    const double factor = FloatFactor();
    if (!is_double_) return factor;
    const double wide = WithMoreBits(static_cast<float>(factor), *random_);
    // Of subnormal points the products are less than any double.
    if (kind_ != PointKind::kSubnormal || OneIn(2, *random_)) return wide;
    return std::ldexp(wide, -RandomExponent(0, 920, *random_));
  }

  double Rounded(double value) const {
    return is_double_ ? value : static_cast<float>(value);
  }
  double Next(double value, double towards) const {
    return is_double_ ? std::nextafter(value, towards)
                      : std::nextafter(static_cast<float>(value),
                                       static_cast<float>(towards));
  }

 private:
  float FloatFactor() const {
    const float sign = RandomSign(*random_);
    switch (kind_) {
      case PointKind::kUniform:
      case PointKind::kCancelling:
        return sign * RandomMantissa(*random_);
      case PointKind::kWideExponents:
      case PointKind::kSubnormal:
        return sign * std::ldexp(RandomMantissa(*random_),
                                 RandomExponent(-149, -4, *random_));
      case PointKind::kPowersOfTwo:
        return std::ldexp(sign, RandomExponent(-100, 1, *random_));
      case PointKind::kTies:
        return sign * std::nextafter(1.f, RandomSign(*random_) * 2.f);
    }
    return sign;
  }

  PointKind kind_;
  bool is_double_;
  Random* random_;
};

namespace internal {

// Lengths of 1 / sqrt(dims) times the sum of the center's coordinates, or
// coordinates that add up to almost sqrt(dims) times the radius: D of the
// sphere is next to nothing, on one side.
inline void MakeCancelling(const RandomNumbers& numbers,
                           std::span<double> center, double& radius,
                           Random& random) {
  const auto dims = static_cast<double>(center.size());
  if (OneIn(2, random)) {
    double sum = 0.0;
    for (double x : center) sum += x;
    radius = numbers.Rounded(std::fabs(sum) / std::sqrt(dims));
    return;
  }
  const double sign = RandomSign(random);
  mpf_class left(dims, 500);  // bits enough for all the parts
  left = sqrt(left) * radius;
  for (double& x : center) {
    x = numbers.Rounded(left.get_d());
    left -= x;
    x *= sign;
  }
  if (OneIn(2, random)) {
    double& x = center[random() % center.size()];
    x = numbers.Next(
        x, RandomSign(random) * std::numeric_limits<double>::infinity());
  }
}

}  // namespace internal

// Some numbers become anything at all, or a neighbour of another one. A box or
// a bound may become Everything(), Empty(), or what engines initialise boxes
// to.
inline void Spoil(const Builder& builder, Shape& shape, Random& random) {
  const std::size_t count = builder.roles.size();
  const std::size_t planes = builder.first_argument();
  const bool has_sides =
      builder.roles[0] == Role::kMinimum || builder.roles[0] == Role::kMaximum;
  if (has_sides && OneIn(8, random)) {
    const double most = builder.is_double ? std::numeric_limits<double>::max()
                                          : std::numeric_limits<float>::max();
    const double minima[] = {std::numeric_limits<float>::infinity(), -most,
                             most};
    const double minimum = minima[random() % 3];
    const bool is_second = builder.change == Change::kMerge && OneIn(2, random);
    for (std::size_t p = 0; p < planes; ++p) {
      const bool is_minimum = builder.roles[p] == Role::kMinimum;
      shape.Set(is_second ? planes + p : p, is_minimum ? minimum : -minimum);
    }
  }
  for (std::size_t n = random() % 4; n-- > 0;) {
    const std::size_t at = random() % count;
    const double other = builder.Number(shape, random() % count);
    const float towards =
        RandomSign(random) * std::numeric_limits<float>::infinity();
    const auto bits = random();
    switch (random() % 5) {
      case 0:
        shape.Set(at, SpecialValue<float>(random));
        break;
      case 1:
        shape.Set(at, SpecialValue<double>(random));
        break;
      case 2:
        shape.Set(at, std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
        break;
      case 3:
        shape.Set(at, std::bit_cast<double>(bits));
        break;
      default:
        shape.floats[at] = std::nextafter(static_cast<float>(other), towards);
        shape.doubles[at] = std::nextafter(other, double{towards});
    }
  }
}

inline Shape RandomShape(const Builder& builder, PointKind kind,
                         Random& random) {
  const std::size_t dims = builder.dims;
  const std::size_t count = builder.roles.size();
  const std::size_t first = builder.first_argument();
  const RandomNumbers numbers(kind, builder.is_double, random);
  const RandomNumbers map_numbers(kind, builder.is_map_double, random);
  std::array<double, kMostNumbers> values{};
  const std::span all(values);
  // Bounds of bounds treat each plane on its own.
  const std::size_t width = builder.kind == Kind::kChange ? dims + 1 : dims;
  for (std::size_t i = 0; i < first; i += width) {
    numbers.FillPoint(all.subspan(i, std::min(width, first - i)));
  }
  for (std::size_t i = 0; i < first; ++i) {
    if (builder.roles[i] == Role::kLength) {
      // Of a sphere a length; what a direction or an axis is multiplied with.
      values[i] =
          builder.kind == Kind::kSphere || builder.kind == Kind::kCapsule
              ? numbers.Length()
          : OneIn(8, random) ? 0
                             : std::fabs(numbers.Factor());
    }
    if (builder.roles[i] == Role::kMaximum && builder.kind != Kind::kChange &&
        values[i - dims] > values[i]) {
      std::swap(values[i - dims], values[i]);
    }
    // Now and then a plane has no bound.
    if (builder.kind == Kind::kChange && OneIn(16, random)) {
      constexpr float kMost = std::numeric_limits<float>::max();
      values[i] = builder.roles[i] == Role::kMinimum ? -kMost : kMost;
    }
  }
  switch (builder.kind) {
    case Kind::kSphere:
    case Kind::kCapsule:
      if (kind == PointKind::kCancelling) {
        internal::MakeCancelling(numbers, all.first(dims), values[count - 1],
                                 random);
      }
      if (builder.kind == Kind::kCapsule && OneIn(4, random)) {
        std::copy_n(all.begin(), dims, all.begin() + dims);
      }
      break;
    case Kind::kImageOfPoints:
    case Kind::kImageOfBox: {
      const std::span map = all.subspan(first, dims * dims + dims);
      map_numbers.FillPoint(map.last(dims));
      for (std::size_t i = 0; i < dims; ++i) {
        double sum = 0;
        for (std::size_t k = 0; k < dims; ++k) {
          map[i * dims + k] = map_numbers.Factor();
          sum += map[i * dims + k] * values[k];
        }
        // Takes the first point almost back to the origin.
        if (kind == PointKind::kCancelling) {
          map[dims * dims + i] = map_numbers.Rounded(-sum);
        }
      }
      break;
    }
    case Kind::kChange:
      switch (builder.change) {
        case Change::kMerge:
          numbers.FillPoint(all.subspan(first, count - first));
          break;
        case Change::kInflate:
        case Change::kInflateByBox:
          values[first] = numbers.Length();
          if (kind == PointKind::kCancelling &&
              std::fabs(values[dims]) < 0x1p100) {
            values[first] = numbers.Rounded(
                std::fabs(values[dims]) / std::sqrt(static_cast<double>(dims)));
          }
          break;
        case Change::kTranslate:
        case Change::kTranslateVertices:
        case Change::kSweep:
          numbers.FillPoint(all.subspan(first, dims));
          for (std::size_t k = 0; k < dims; ++k) {
            if (kind == PointKind::kCancelling &&
                std::fabs(values[k]) < 0x1p100) {
              values[first + k] = -values[k];
            }
          }
          break;
        case Change::kScale:
          values[first] = OneIn(16, random) ? 0 : numbers.Factor();
          if (builder.part >= Part::kUp)
            values[first] = std::fabs(values[first]);
          break;
      }
      break;
    default:
      break;
  }
  Shape shape;
  for (std::size_t i = 0; i < count; ++i) shape.Set(i, values[i]);
  return shape;
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_FIT_RANDOM_SHAPES_H_
