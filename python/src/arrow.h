// Columns of the Arrow C data interface.
#ifndef HALFSPACE_PYTHON_ARROW_H_
#define HALFSPACE_PYTHON_ARROW_H_

#include <pybind11/numpy.h>

#include <string>

namespace halfspace::python {

// Returns a NumPy array of the memory of an object with __arrow_c_array__. The
// array keeps the memory alive. Throws for nulls, and for types other than
// float and double. `name` is the argument that messages name.
pybind11::array ArrowColumn(const pybind11::object& object,
                            const std::string& name);

}  // namespace halfspace::python

#endif  // HALFSPACE_PYTHON_ARROW_H_
