// Columns of the Arrow C data interface.
#include <pybind11/numpy.h>

#include <cstdint>
#include <string>

#include "module.h"

namespace py = pybind11;

namespace halfspace::python {
namespace {

// https://arrow.apache.org/docs/format/CDataInterface.html
struct ArrowSchema {
  const char* format;
  const char* name;
  const char* metadata;
  std::int64_t flags;
  std::int64_t n_children;
  ArrowSchema** children;
  ArrowSchema* dictionary;
  void (*release)(ArrowSchema*);
  void* private_data;
};

struct ArrowArray {
  std::int64_t length;
  std::int64_t null_count;
  std::int64_t offset;
  std::int64_t n_buffers;
  std::int64_t n_children;
  const void** buffers;
  ArrowArray** children;
  ArrowArray* dictionary;
  void (*release)(ArrowArray*);
  void* private_data;
};

// Returns the structure in a capsule. The capsule stays its owner.
template <typename Struct>
const Struct& In(const py::handle& capsule, const char* kind,
                 const std::string& name) {
  const auto* content =
      static_cast<Struct*>(PyCapsule_GetPointer(capsule.ptr(), kind));
  if (content == nullptr) throw py::error_already_set();
  if (content->release == nullptr) {
    throw py::value_error(name +
                          ": expected an Arrow array, got one that was "
                          "released");
  }
  return *content;
}

// Throws for nulls, and for types other than float and double. `name` is the
// argument that messages name.
py::array ArrowColumn(const py::object& object, const std::string& name) {
  const py::object made = object.attr("__arrow_c_array__")();
  if (!py::isinstance<py::tuple>(made) || py::len(made) != 2) {
    throw py::type_error(name +
                         ": expected __arrow_c_array__() to return two "
                         "capsules");
  }
  const auto capsules = py::reinterpret_borrow<py::tuple>(made);
  const auto& schema = In<ArrowSchema>(capsules[0], "arrow_schema", name);
  const auto& array = In<ArrowArray>(capsules[1], "arrow_array", name);
  const std::string format = schema.format;
  if (format != "f" && format != "g") {
    throw py::type_error(name +
                         ": expected an Arrow array of float or double, "
                         "got the Arrow format \"" +
                         format + "\"");
  }
  if (array.n_buffers != 2 || array.length < 0 || array.offset < 0) {
    throw py::value_error(name +
                          ": expected an Arrow array with 2 buffers, "
                          "got a malformed one");
  }
  const auto* present = static_cast<const std::uint8_t*>(array.buffers[0]);
  if (array.null_count != 0 && present != nullptr) {
    for (std::int64_t i = 0; i < array.length; ++i) {
      const std::int64_t bit = array.offset + i;
      if ((present[bit / 8] >> bit % 8 & 1) == 0) {
        throw py::value_error(name + ": expected numbers, got a null in row " +
                              std::to_string(i));
      }
    }
  }
  const py::dtype type =
      format == "f" ? py::dtype::of<float>() : py::dtype::of<double>();
  const auto* values = static_cast<const char*>(array.buffers[1]);
  if (array.length == 0 || values == nullptr) return py::array(type, 0);
  return py::array(type, {array.length}, {type.itemsize()},
                   values + array.offset * type.itemsize(), capsules[1]);
}

}  // namespace

void DefineArrow(py::module_& module) {
  module.def("arrow_column", &ArrowColumn);
}

}  // namespace halfspace::python
