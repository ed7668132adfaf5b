#include "columns.h"

#include <stdexcept>

namespace py = pybind11;

namespace halfspace::python {

Columns::Columns(const py::tuple& arrays) : arrays_(arrays) {
  // _arrays.py guarantees all of this. A call of the private module by somebody
  // else fails here, before it reads wrong memory.
  const auto check = [](bool is_right) {
    if (!is_right) {
      throw std::invalid_argument("_halfspace: arrays that are not prepared");
    }
  };
  bool is_first = true;
  for (const py::handle item : arrays) {
    check(py::isinstance<py::array>(item));
    const auto array = py::reinterpret_borrow<py::array>(item);
    const bool is_double = py::isinstance<py::array_t<double>>(array);
    check(is_double || py::isinstance<py::array_t<float>>(array));
    check(array.ndim() == 2);
    check((array.flags() & py::detail::npy_api::NPY_ARRAY_ALIGNED_) != 0);
    const py::ssize_t size = is_double ? sizeof(double) : sizeof(float);
    const auto count = static_cast<std::size_t>(array.shape(0));
    const py::ssize_t stride = count > 1 ? array.strides(0) : size;
    check(stride > 0 && stride % size == 0);
    if (is_first) {
      count_ = count;
      stride_ = static_cast<std::size_t>(stride / size);
      is_double_ = is_double;
      is_first = false;
    }
    check(count == count_ && is_double == is_double_ &&
          static_cast<std::size_t>(stride / size) == stride_);
    for (py::ssize_t k = 0; k < array.shape(1); ++k) {
      first_.push_back(static_cast<const char*>(array.data()) +
                       k * array.strides(1));
    }
  }
  check(!is_first);
}

}  // namespace halfspace::python
