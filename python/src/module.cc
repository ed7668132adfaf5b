// The extension module halfspace._halfspace: what the Python files of the
// package call, with arguments that they have checked (_arrays.py).
#include <halfspace/fit_many.h>
#include <halfspace/targets.h>
#include <halfspace/version.h>
#include <pybind11/numpy.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "arrow.h"
#include "broad_phase.h"
#include "columns.h"
#include "scan.h"
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

py::array_t<float> RoundUpEach(
    const py::array_t<double, py::array::c_style>& values) {
  py::array_t<float> rounded(values.size());
  float* const to = rounded.mutable_data();
  const Span<const double> from(values.data(),
                                static_cast<std::size_t>(values.size()));
  const py::gil_scoped_release release;
  detail::RoundOutward(from, 0, 1, to);
  return rounded;
}

// Writes the boxes to an array of shape (triangles, 2 d) whose columns are
// contiguous, as builders write and read them. Returns it and the number of the
// first triangle without a box, or -1.
template <int kDims, typename Scalar>
py::tuple BoundsOfTriangles(const py::array& vertices,
                            const py::array_t<std::uint32_t>& faces) {
  const auto count = static_cast<std::size_t>(faces.shape(0));
  py::array_t<float, py::array::f_style> boxes(
      std::vector<std::size_t>{count, 2 * kDims});
  AabbPlanes<kDims> planes;
  for (std::size_t k = 0; k < kDims; ++k) {
    planes.min[k] = boxes.mutable_data() + k * count;
    planes.max[k] = boxes.mutable_data() + (kDims + k) * count;
  }
  planes.size = count;
  Points<kDims, Scalar> points;
  points.coords = static_cast<const Scalar*>(vertices.data());
  points.count = static_cast<std::size_t>(vertices.shape(0));
  FitStatus status;
  {
    const py::gil_scoped_release release;
    BoundTriangles(points, Span<const std::uint32_t>(faces.data(), 3 * count),
                   planes, {}, &status);
  }
  return py::make_tuple(
      boxes, status.everything == 0
                 ? -1
                 : static_cast<py::ssize_t>(status.first_everything));
}

py::tuple BoundsOfAnyTriangles(const py::array& vertices,
                               const py::array_t<std::uint32_t>& faces) {
  const bool is_double = py::isinstance<py::array_t<double>>(vertices);
  constexpr int kWanted =
      int{py::detail::npy_api::NPY_ARRAY_ALIGNED_} | int{py::array::c_style};
  if ((!is_double && !py::isinstance<py::array_t<float>>(vertices)) ||
      vertices.ndim() != 2 || (vertices.flags() & kWanted) != kWanted ||
      (vertices.shape(1) != 2 && vertices.shape(1) != 3) || faces.ndim() != 2 ||
      faces.shape(1) != 3 || (faces.flags() & kWanted) != kWanted) {
    throw std::invalid_argument("_halfspace: arrays that are not prepared");
  }
  if (vertices.shape(1) == 2) {
    return is_double ? BoundsOfTriangles<2, double>(vertices, faces)
                     : BoundsOfTriangles<2, float>(vertices, faces);
  }
  return is_double ? BoundsOfTriangles<3, double>(vertices, faces)
                   : BoundsOfTriangles<3, float>(vertices, faces);
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
  module.def("round_up", &RoundUpEach);
  module.def("targets", [] {
    py::list names;
    for (const halfspace::Target target : halfspace::SupportedTargets()) {
      names.append(py::str(std::string(target.name())));
    }
    return names;
  });
  module.def("arrow_column", &ArrowColumn);
  module.def("bounds_of_triangles", &BoundsOfAnyTriangles);
  DefineBroadPhase(module);
  DefineTree(module);
  DefineScan(module);
}
