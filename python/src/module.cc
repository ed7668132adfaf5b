// The extension module halfspace._halfspace: what the Python files of the
// package call, with arguments that they have checked (_arrays.py).

#include <halfspace/c/halfspace.h>
#include <pybind11/numpy.h>

#include <cstddef>
#include <vector>

#include "columns.h"

namespace py = pybind11;

namespace halfspace::python {
namespace {

// Returns the boxes, of shape (triangles, 2 d), and the number of triangles
// without one.
py::tuple BoundsOfTriangles(const py::array& vertices, const ShortIds& faces) {
  const Columns points(py::make_tuple(vertices));
  if ((points.size != 2 && points.size != 3) || faces.ndim() != 2 ||
      faces.shape(1) != 3) {
    ThrowNotPrepared();
  }
  const auto count = static_cast<std::size_t>(faces.shape(0));
  py::array_t<float> boxes(std::vector<std::size_t>{count, 2 * points.size});
  float* const to = boxes.mutable_data();
  std::size_t everything = 0;
  {
    const py::gil_scoped_release release;
    Check(hs_bound_faces(points.size == 2 ? HS_BOX2 : HS_BOX3, &points,
                         faces.data(), count, nullptr, to, &everything));
  }
  return py::make_tuple(boxes, everything);
}

}  // namespace
}  // namespace halfspace::python

PYBIND11_MODULE(_halfspace, module) {
  using namespace halfspace::python;
  module.doc() = "The compiled part of halfspace. Private: use halfspace.";
  module.attr("version") = hs_version();
  module.def("can_read",
             [](const py::tuple& arrays) { return Columns().Read(arrays); });
  module.def("first_bad_box", [](const py::tuple& arrays, bool are_points) {
    const Columns boxes(arrays);
    const std::size_t half = boxes.size / 2;
    const py::gil_scoped_release release;
    return are_points ? FirstBadBox(boxes, boxes.size, 0)
                      : FirstBadBox(boxes, half, half);
  });
  module.def("targets", [] {
    py::list names;
    for (std::size_t i = 0; i < hs_target_count(); ++i) {
      names.append(hs_target_name(i));
    }
    return names;
  });
  module.def("bounds_of_triangles", &BoundsOfTriangles);
  DefineBroadPhase(module);
  DefineMesh(module);
  DefineTree(module);
  DefineScan(module);
  DefineGeos(module);
}
