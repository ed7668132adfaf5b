#include "columns.h"

#include <algorithm>
#include <limits>
#include <new>
#include <stdexcept>
#include <string>

namespace py = pybind11;

namespace halfspace::python {
namespace {

std::size_t BytesOf(const hs_columns& columns) {
  return columns.type == HS_FLOAT64 ? sizeof(double) : sizeof(float);
}

bool IsAligned(const py::array& array) {
  return (array.flags() & py::detail::npy_api::NPY_ARRAY_ALIGNED_) != 0;
}

// Returns false for another type than float and double. Takes a third of the
// time of py::isinstance().
bool ReadType(const py::array& array, hs_scalar& type) {
  const py::dtype its = array.dtype();
  const bool is_double = its.num() == py::detail::npy_api::NPY_DOUBLE_;
  type = is_double ? HS_FLOAT64 : HS_FLOAT32;
  return (is_double || its.num() == py::detail::npy_api::NPY_FLOAT_) &&
         its.byteorder() == '=';
}

template <typename Scalar>
std::ptrdiff_t FirstBadBoxOf(const hs_columns& boxes, std::size_t dims,
                             std::size_t first_maximum) {
  constexpr Scalar kInf = std::numeric_limits<Scalar>::infinity();
  for (std::size_t i = 0; i < boxes.count; ++i) {
    bool is_good = true;
    bool is_empty = true;
    for (std::size_t k = 0; k < dims; ++k) {
      const auto at = [&](std::size_t column) {
        return static_cast<const Scalar*>(
            boxes.column[column])[i * boxes.stride];
      };
      const Scalar min = at(k);
      const Scalar max = at(first_maximum + k);
      is_good &= min <= max;  // not for a NaN
      is_empty &= min == kInf && max == -kInf;
    }
    if (!is_good && !is_empty) return static_cast<std::ptrdiff_t>(i);
  }
  return -1;
}

template <typename Scalar>
hs_columns CopyOf(const Columns& records, std::size_t first, std::size_t count,
                  std::vector<std::byte>& copy) {
  copy.resize(records.size * count * sizeof(Scalar));
  auto* const to = reinterpret_cast<Scalar*>(copy.data());
  hs_columns result{};
  result.type = records.type;
  result.count = count;
  result.stride = records.size;
  for (std::size_t v = 0; v < records.size; ++v) {
    const auto* const from = static_cast<const Scalar*>(records.column[v]);
    result.column[v] = to + v;
    for (std::size_t i = 0; i < count; ++i) {
      to[records.size * i + v] =
          from[records.order[first + i] * records.stride];
    }
  }
  return result;
}

}  // namespace

void Check(hs_status status) {
  if (status == HS_OK) return;
  if (status == HS_OUT_OF_MEMORY) throw std::bad_alloc();
  std::string text = hs_last_error_argument();
  text += (text.empty() ? "" : ": ") + std::string(hs_last_error_reason());
  if (status == HS_INTERNAL) throw std::runtime_error(text);
  throw std::invalid_argument(text);
}

void ThrowNotPrepared() {
  throw std::invalid_argument("_halfspace: arrays that are not prepared");
}

bool Columns::Read(const py::tuple& arrays) {
  bool is_first = true;
  for (const py::handle item : arrays) {
    if (!py::isinstance<py::array>(item)) return false;
    const auto array = py::reinterpret_borrow<py::array>(item);
    hs_columns its{};
    if (!ReadType(array, its.type) || array.ndim() != 2 || !IsAligned(array)) {
      return false;
    }
    const auto bytes = Size(BytesOf(its));
    its.count = static_cast<std::size_t>(array.shape(0));
    const py::ssize_t step = its.count > 1 ? array.strides(0) : bytes;
    if (step <= 0 || step % bytes != 0) return false;
    its.stride = static_cast<std::size_t>(step / bytes);
    if (is_first) static_cast<hs_columns&>(*this) = its;
    is_first = false;
    if (its.type != type || its.count != count || its.stride != stride ||
        size + static_cast<std::size_t>(array.shape(1)) > HS_MAX_COLUMNS) {
      return false;
    }
    for (py::ssize_t k = 0; k < array.shape(1); ++k) {
      column[size++] =
          static_cast<const char*>(array.data()) + k * array.strides(1);
    }
  }
  return !is_first;
}

hs_columns Columns::Rows(std::size_t first, std::size_t most) const {
  hs_columns rows = *this;
  rows.count = std::min(most, count - first);
  for (std::size_t k = 0; k < size; ++k) {
    rows.column[k] =
        static_cast<const char*>(column[k]) + first * stride * BytesOf(*this);
  }
  return rows;
}

hs_columns Columns::Part(std::size_t first, std::size_t most,
                         std::vector<std::byte>& copy) const {
  if (order.empty()) return Rows(first, most);
  const std::size_t some = std::min(most, count - first);
  return type == HS_FLOAT64 ? CopyOf<double>(*this, first, some, copy)
                            : CopyOf<float>(*this, first, some, copy);
}

hs_columns BoxIn(const py::array& array, std::size_t dims) {
  hs_columns box{};
  if (array.ndim() != 1 || array.shape(0) != Size(2 * dims) ||
      !ReadType(array, box.type) || array.strides(0) != Size(BytesOf(box)) ||
      !IsAligned(array)) {
    return box;
  }
  box.count = 1;
  for (std::size_t k = 0; k < 2 * dims; ++k) {
    box.column[k] = static_cast<const char*>(array.data()) + k * BytesOf(box);
  }
  if (FirstBadBox(box, dims, dims) >= 0) box.count = 0;
  return box;
}

std::ptrdiff_t FirstBadBox(const hs_columns& boxes, std::size_t dims,
                           std::size_t first_maximum) {
  return boxes.type == HS_FLOAT64
             ? FirstBadBoxOf<double>(boxes, dims, first_maximum)
             : FirstBadBoxOf<float>(boxes, dims, first_maximum);
}

}  // namespace halfspace::python
