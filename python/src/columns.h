// Boxes and points in the memory of NumPy arrays.
#ifndef HALFSPACE_PYTHON_COLUMNS_H_
#define HALFSPACE_PYTHON_COLUMNS_H_

#include <halfspace/bounds.h>
#include <halfspace/shapes.h>
#include <halfspace/span.h>
#include <halfspace/transform.h>
#include <pybind11/numpy.h>

#include <array>
#include <cstddef>
#include <optional>
#include <type_traits>
#include <vector>

namespace halfspace::python {

// A size as pybind11 takes it.
inline pybind11::ssize_t Size(std::size_t size) {
  return static_cast<pybind11::ssize_t>(size);
}

// The least float that is not below a number.
inline float RoundUp(double value) {
  float rounded;
  detail::RoundOutward(Span<const double>(&value, 1), 0, 1, &rounded);
  return rounded;
}

// Columns of floats or doubles. Two values of a column that follow each other
// are `stride` values apart in memory. The columns are those of the first
// array, then those of the next. _arrays.py has prepared the arrays: they have
// two dimensions, the same type, length and stride, and this machine's byte
// order.
class Columns {
 public:
  explicit Columns(const pybind11::tuple& arrays);

  std::size_t count() const { return count_; }
  std::size_t stride() const { return stride_; }
  std::size_t columns() const { return first_.size(); }
  bool is_double() const { return is_double_; }

  template <typename Scalar>
  const Scalar* Column(std::size_t k) const {
    return static_cast<const Scalar*>(first_[k]);
  }

  // Calls function(Boxes) with the boxes of floats or of doubles.
  template <int kDims, typename Function>
  auto WithBoxes(Function&& function) const {
    if (is_double_) return function(BoxesOfScalar<kDims, double>());
    return function(BoxesOfScalar<kDims, float>());
  }

  // Writes box first ... first + count - 1. Doubles are rounded outward.
  template <int kDims>
  void GetBoxes(std::size_t first, std::size_t count, Aabb<kDims>* to) const {
    if (is_double_) {
      CopyBoxes<kDims, double>(first, count, to);
    } else {
      CopyBoxes<kDims, float>(first, count, to);
    }
  }

  // Writes some columns of row first ... first + count - 1, as the minimum and
  // the maximum of a box: the point itself, or the floats next to a double.
  template <int kDims>
  void GetPoints(std::size_t first, std::size_t count, Aabb<kDims>* to) const {
    for (std::size_t i = 0; i < count; ++i) {
      if (is_double_) {
        Aabb<kDims, double> box;
        for (std::size_t k = 0; k < kDims; ++k) {
          box.min[k] = box.max[k] = Column<double>(k)[(first + i) * stride_];
        }
        to[i] = RoundOutward(box);
      } else {
        for (std::size_t k = 0; k < kDims; ++k) {
          to[i].min[k] = to[i].max[k] = Column<float>(k)[(first + i) * stride_];
        }
      }
    }
  }

  // One value as the nearest float.
  float Get(std::size_t row, std::size_t k) const {
    const std::size_t at = row * stride_;
    return is_double_ ? static_cast<float>(Column<double>(k)[at])
                      : Column<float>(k)[at];
  }

  // The first columns of a row as the nearest floats.
  template <int kDims>
  Point<kDims> GetPoint(std::size_t row) const {
    Point<kDims> point;
    for (std::size_t k = 0; k < kDims; ++k) point[k] = Get(row, k);
    return point;
  }

 private:
  template <int kDims, typename Scalar>
  Boxes<kDims, Scalar> BoxesOfScalar() const {
    Boxes<kDims, Scalar> boxes;
    for (std::size_t k = 0; k < kDims; ++k) {
      boxes.min[k] = Column<Scalar>(k);
      boxes.max[k] = Column<Scalar>(kDims + k);
    }
    boxes.count = count_;
    boxes.stride = stride_;
    return boxes;
  }

  template <int kDims, typename Scalar>
  void CopyBoxes(std::size_t first, std::size_t count, Aabb<kDims>* to) const {
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t at = (first + i) * stride_;
      Aabb<kDims, Scalar> box;
      for (std::size_t k = 0; k < kDims; ++k) {
        box.min[k] = Column<Scalar>(k)[at];
        box.max[k] = Column<Scalar>(kDims + k)[at];
      }
      if constexpr (std::is_same_v<Scalar, double>) {
        to[i] = RoundOutward(box);
      } else {
        to[i] = box;
      }
    }
  }

  pybind11::tuple arrays_;
  std::vector<const void*> first_;
  std::size_t count_ = 0;
  std::size_t stride_ = 1;
  bool is_double_ = false;
};

template <int kDims, typename Scalar>
std::optional<Aabb<kDims>> BoxOfScalar(const pybind11::array& array) {
  if (!pybind11::isinstance<pybind11::array_t<Scalar>>(array)) {
    return std::nullopt;
  }
  Aabb<kDims, Scalar> box;
  const auto* const values = static_cast<const Scalar*>(array.data());
  for (std::size_t k = 0; k < kDims; ++k) {
    box.min[k] = values[k];
    box.max[k] = values[kDims + k];
    if (!(box.min[k] <= box.max[k])) return std::nullopt;
  }
  if constexpr (std::is_same_v<Scalar, float>) {
    return box;
  } else {
    return RoundOutward(box);
  }
}

// The box that a plain array has, rounded outward. Nothing if the array needs a
// closer look.
template <int kDims>
std::optional<Aabb<kDims>> BoxIn(const pybind11::array& array) {
  if (array.ndim() != 1 || array.shape(0) != 2 * kDims ||
      array.strides(0) != array.itemsize() ||
      (array.flags() & pybind11::detail::npy_api::NPY_ARRAY_ALIGNED_) == 0) {
    return std::nullopt;
  }
  const auto box = BoxOfScalar<kDims, float>(array);
  return box ? box : BoxOfScalar<kDims, double>(array);
}

}  // namespace halfspace::python

#endif  // HALFSPACE_PYTHON_COLUMNS_H_
