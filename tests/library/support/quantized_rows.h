// The kinds of quantized worlds as rows, for tests that are compiled once for
// all of them.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_QUANTIZED_ROWS_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_QUANTIZED_ROWS_H_

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstring>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "halfspace/quantized.h"
#include "tests/library/support/any_world.h"
#include "tests/library/support/dims.h"
#include "tests/library/support/quantized_cases.h"

namespace halfspace::testing {

// Bounds as floats, as quantized bounds, and as a quantized world.
class AnyQuantized {
 public:
  virtual ~AnyQuantized() = default;

  virtual AnyWorld floats() const = 0;
  virtual AnyWorld quantized() const = 0;
  virtual AnyWorld refined() const = 0;
  virtual AnyWorld world() = 0;  // as it was made
  virtual bool Fits() const = 0;
  // Quantized bounds alone: replaces or adds the values of an object.
  virtual void Set(std::size_t i, const float* values) = 0;
  virtual void Push(const float* values) = 0;
};

struct QuantizedRow {
  std::string name;
  detail::PlaneLayout layout;
  std::size_t element_bytes;
  std::unique_ptr<AnyQuantized> (*make)(const std::vector<float>& values);

  std::size_t planes() const { return layout.plane_count; }
  bool IsMinPlane(std::size_t p) const { return p < layout.axes; }
  friend std::ostream& operator<<(std::ostream& out, const QuantizedRow& row) {
    return out << row.name;
  }
};

// In all dimensions that the library has.
std::vector<QuantizedRow> AllQuantizedRows();

// In those that are tested.
[[maybe_unused]] static std::vector<QuantizedRow> QuantizedRows() {
  return InDims(TestDims(), AllQuantizedRows(), [](const QuantizedRow& row) {
    return std::size_t{row.layout.dims};
  });
}

inline std::string QuantizedRowName(
    const ::testing::TestParamInfo<QuantizedRow>& info) {
  return info.param.name;
}

// Queries that a part of the objects survive (MakeQuantizedQuery()).
class QuantizedQueries {
 public:
  QuantizedQueries() = default;
  QuantizedQueries(const QuantizedRow& row, const std::vector<float>& bounds,
                   std::size_t count, Random& random)
      : planes_(row.planes()), values_(count * planes_) {
    for (std::size_t q = 0; q < count; ++q) {
      internal::FillQuantizedQuery(row.layout, bounds.data(),
                                   bounds.size() / planes_, random,
                                   &values_[q * planes_]);
    }
  }

  AnyQueries Some(std::size_t first, std::size_t count) const {
    return {values_.data() + first * planes_, count};
  }

 private:
  std::size_t planes_ = 0;
  std::vector<float> values_;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_QUANTIZED_ROWS_H_
