// The kinds of flat worlds of cases.h as rows, for tests that are compiled once
// for all of them, and inputs for each (inputs.h).
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_FLAT_CASES_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_FLAT_CASES_H_

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <ostream>
#include <random>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "tests/library/support/any_world.h"
#include "tests/library/support/cases.h"
#include "tests/library/support/dims.h"
#include "tests/library/support/inputs.h"

namespace halfspace::testing {

struct FlatCase {
  std::string name;
  detail::PlaneLayout layout;
  bool is_double;
  AnyWorld (*world)(const PlanePointers& planes, std::size_t size);

  std::size_t scalar_bytes() const {
    return is_double ? sizeof(double) : sizeof(float);
  }
  std::size_t query_bytes() const {
    return layout.plane_count * scalar_bytes();
  }

  bool IsMinPlane(std::size_t p) const { return p < layout.axes; }
  std::size_t Opposing(std::size_t p) const { return OpposingValue(layout, p); }
  // What calls name it.
  std::string PlaneName(std::size_t p) const {
    return IsMinPlane(p) ? "world.min[" + std::to_string(p) + "]"
                         : "world.max[" + std::to_string(p - layout.axes) + "]";
  }

  // Calls f(Scalar()) with the type of the values.
  template <typename F>
  auto WithScalar(F f) const {
    return is_double ? f(double{}) : f(float{});
  }

  friend std::ostream& operator<<(std::ostream& out, const FlatCase& of) {
    return out << of.name;
  }
};

// In all dimensions that the library has.
std::vector<FlatCase> AllFlatRows();

// In those that are tested.
[[maybe_unused]] static std::vector<FlatCase> AllFlatCases() {
  return InDims(TestDims(), AllFlatRows());
}

// The planes of a world, and a query.
class FlatInput {
 public:
  FlatInput(const FlatCase& kind, InputKind input, std::size_t objects,
            Random& random)
      : kind_(&kind), query_(kind.query_bytes()) {
    kind.WithScalar([&]<typename T>(T) {
      for (std::size_t p = 0; p < kind.layout.plane_count; ++p) {
        auto& plane = planes_.emplace_back(objects * sizeof(T));
        reinterpret_cast<T*>(query_.data())[kind.Opposing(p)] =
            FillPlane<T>(input, kind.IsMinPlane(p),
                         {reinterpret_cast<T*>(plane.data()), objects}, random);
      }
    });
  }

  // Of the planes in memory.
  std::span<const std::byte> Plane(std::size_t p) const { return planes_[p]; }

  AnyQueries query() const { return {query_.data(), 1}; }

  // `size` objects, each plane from an element of its own on, so that no two
  // planes share an alignment: up to `misalignments` elements further than the
  // first.
  AnyWorld WorldAt(std::size_t offset, std::size_t size,
                   std::size_t misalignments) const {
    PlanePointers pointers{};
    for (std::size_t p = 0; p < planes_.size(); ++p) {
      pointers[p] = planes_[p].data() +
                    (offset + 3 * p) % misalignments * kind_->scalar_bytes();
    }
    return kind_->world(pointers, size);
  }

 private:
  const FlatCase* kind_;
  std::vector<std::vector<std::byte>> planes_;
  std::vector<std::byte> query_;
};

// Queries around that of the input. Half of their values are the input's own,
// so that all of them have survivors; the others are elsewhere, one ulp away,
// or special, so that no two answers are alike.
class FlatQueries {
 public:
  FlatQueries() = default;
  FlatQueries(const FlatCase& kind, const FlatInput& input, std::size_t count,
              Random& random)
      : bytes_(kind.query_bytes()), records_(count * bytes_) {
    kind.WithScalar([&]<typename T>(T) {
      constexpr T kInfinity = std::numeric_limits<T>::infinity();
      std::uniform_real_distribution<T> shift(T{-40}, T{60});
      for (std::size_t q = 0; q < count; ++q) {
        T values[10] = {};
        std::memcpy(values, input.query().records, bytes_);
        for (std::size_t p = 0; p < kind.layout.plane_count; ++p) {
          T& value = values[kind.Opposing(p)];
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
              value += kind.IsMinPlane(p) ? shift(random) : -shift(random);
              break;
            default:
              break;
          }
        }
        std::memcpy(&records_[q * bytes_], values, bytes_);
      }
    });
  }

  std::span<const std::byte> records() const { return records_; }

  AnyQueries Some(std::size_t first, std::size_t count) const {
    return {records_.data() + first * bytes_, count};
  }

 private:
  std::size_t bytes_ = 0;
  std::vector<std::byte> records_;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_FLAT_CASES_H_
