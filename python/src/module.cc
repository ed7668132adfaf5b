// The extension module halfspace._halfspace: what the Python files of the
// package call, with arguments that they have checked (_arrays.py).
#include <halfspace/fit_many.h>
#include <halfspace/targets.h>
#include <halfspace/version.h>
#include <pybind11/pybind11.h>

#include <cmath>
#include <limits>
#include <string>

#include "columns.h"
#include "tree.h"

namespace py = pybind11;

namespace halfspace::python {
namespace {

template <typename Scalar>
py::ssize_t FirstBadBox(const Columns& boxes) {
  constexpr Scalar kInf = std::numeric_limits<Scalar>::infinity();
  const std::size_t dims = boxes.columns() / 2;
  for (std::size_t i = 0; i < boxes.count(); ++i) {
    const std::size_t at = i * boxes.stride();
    bool is_good = true;
    bool is_empty = true;
    for (std::size_t k = 0; k < dims; ++k) {
      const Scalar min = boxes.Column<Scalar>(k)[at];
      const Scalar max = boxes.Column<Scalar>(dims + k)[at];
      is_good &= min <= max;  // not for a NaN
      is_empty &= min == kInf && max == -kInf;
    }
    if (!is_good && !is_empty) return static_cast<py::ssize_t>(i);
  }
  return -1;
}

template <typename Scalar>
py::ssize_t FirstNan(const Columns& values) {
  for (std::size_t i = 0; i < values.count(); ++i) {
    for (std::size_t k = 0; k < values.columns(); ++k) {
      if (std::isnan(values.Column<Scalar>(k)[i * values.stride()])) {
        return static_cast<py::ssize_t>(i);
      }
    }
  }
  return -1;
}

}  // namespace
}  // namespace halfspace::python

PYBIND11_MODULE(_halfspace, module) {
  using namespace halfspace::python;
  module.doc() = "The compiled part of halfspace. Private: use halfspace.";
  module.attr("version") = HALFSPACE_VERSION_STRING;
  module.def("first_bad_box", [](const py::tuple& arrays) {
    const Columns boxes(arrays);
    const py::gil_scoped_release release;
    return boxes.is_double() ? FirstBadBox<double>(boxes)
                             : FirstBadBox<float>(boxes);
  });
  module.def("first_nan", [](const py::tuple& arrays) {
    const Columns values(arrays);
    const py::gil_scoped_release release;
    return values.is_double() ? FirstNan<double>(values)
                              : FirstNan<float>(values);
  });
  module.def("targets", [] {
    py::list names;
    for (const halfspace::Target target : halfspace::SupportedTargets()) {
      names.append(py::str(std::string(target.name())));
    }
    return names;
  });
  DefineTree(module);
}
