// Every builder of single bounds, and every call of transform.h, as the rows of
// a table: each property of builders is one test over all rows.
//
// A shape is a list of numbers, in the order of its type in shapes.h. So one
// loop can try a value in place of each of them.
#ifndef HALFSPACE_TESTS_LIBRARY_FIT_BUILDERS_H_
#define HALFSPACE_TESTS_LIBRARY_FIT_BUILDERS_H_

#include <array>
#include <cstddef>
#include <cstring>
#include <limits>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "halfspace/fit.h"
#include "tests/library/support/dims.h"
#include "tests/library/support/seeded_numbers.h"

namespace halfspace::testing {

enum class Kind {
  kPoints,
  kSegment,
  kTriangle,
  kRay,
  kPieces,  // of a segment
  kBox,
  kOrientedBox,
  kSphere,
  kCapsule,
  kImageOfPoints,  // numbers of the points, then of the map
  kImageOfBox,
  kChange,  // numbers of a bound, then of the argument
};

// How points lie in memory. All but the first have NaN between them.
enum class PointLayout { kPacked, kStrided, kSoa, kIndexed, kIndexedSoa };

// What is done to a bound, by a call of transform.h.
enum class Change {
  kMerge,  // with another bound
  kInflate,
  kInflateByBox,
  kTranslate,
  kTranslateVertices,
  kScale,
  kSweep,
};

enum class Part { kAabo, kAabb, kUp, kDown };

// What a number is, and so which values are bad.
enum class Role {
  kCoordinate,
  kLength,  // refused if it is negative or NaN
  kMinimum,
  kMaximum,
  kFactor,
};

inline constexpr std::size_t kMostNumbers = 40;

// Some rows take the floats, some the doubles, some of both.
struct Shape {
  void Set(std::size_t i, double value) {
    floats[i] = static_cast<float>(value);
    doubles[i] = value;
  }

  std::array<float, kMostNumbers> floats{};
  std::array<double, kMostNumbers> doubles{};
};

inline constexpr std::size_t kPieces = 3;  // of each segment
inline constexpr std::size_t kPointsOfSet = 3;

// The planes of a bound: all minima, then all maxima. Of pieces, one bound
// after another. 0 after the last.
using Planes = std::array<float, 10 * kPieces>;

// As bits, which no floating-point mode can change.
inline bool SameBits(const Planes& a, const Planes& b) {
  return std::memcmp(a.data(), b.data(), sizeof(a)) == 0;
}

struct Builder;

// What the library makes of a shape, by a caller compiled as usual, and by one
// compiled with -ffast-math.
namespace usual {
Planes Build(const Builder& builder, const Shape& shape, FitStatus* status);
}
namespace fast_math {
Planes Build(const Builder& builder, const Shape& shape, FitStatus* status);
}

struct Builder {
  Kind kind;
  std::string_view call;
  std::string name;
  std::size_t dims;
  bool is_double = false;      // the shape
  bool is_map_double = false;  // the map of an image
  PointLayout layout = PointLayout::kPacked;
  Change change = Change::kMerge;
  Part part = Part::kAabo;
  std::vector<Role> roles{};

  Planes Build(const Shape& shape, FitStatus* status = nullptr) const {
    return usual::Build(*this, shape, status);
  }

  // The numbers before those of a map or of the argument of a change.
  std::size_t first_argument() const;
  bool IsDouble(std::size_t i) const {
    return kind >= Kind::kImageOfPoints && i >= first_argument() ? is_map_double
                                                                 : is_double;
  }
  // What the library is given.
  double Number(const Shape& shape, std::size_t i) const {
    return IsDouble(i) ? shape.doubles[i] : shape.floats[i];
  }
  // What an error calls the number.
  std::string Argument(std::size_t i) const;

  // Results, and the planes of each.
  std::size_t results() const { return kind == Kind::kPieces ? kPieces : 1; }
  std::size_t minima() const { return PlanesBut(Part::kDown); }
  std::size_t maxima() const { return PlanesBut(Part::kUp); }
  // Planes on one side, which this part lacks.
  std::size_t PlanesBut(Part none) const;

  Planes Everything() const {
    return Filled(-std::numeric_limits<float>::max());
  }
  Planes Empty() const {
    return Filled(std::numeric_limits<float>::infinity());
  }
  Planes Filled(float minimum) const;

  friend std::ostream& operator<<(std::ostream& out, const Builder& builder) {
    return out << builder.name;
  }
};

// In the dimensions that this build tests.
std::vector<Builder> Builders(
    const std::vector<std::size_t>& dims = TestDims());
std::vector<Builder> Changes(const std::vector<std::size_t>& dims = TestDims());
[[maybe_unused]] static std::vector<Builder> BuildersAndChanges() {
  std::vector<Builder> all = Builders();
  for (Builder& change : Changes()) all.push_back(change);
  return all;
}

// The row of one kind.
const Builder& BuilderOf(Kind kind, std::size_t dims, bool is_double = false);

// All ones.
Shape ShapeOfOnes(const Builder& builder);

// The same on every machine. One in 256 of its coordinates cannot be bounded.
Shape SeededShape(const Builder& builder, SeededNumbers& numbers);

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_FIT_BUILDERS_H_
