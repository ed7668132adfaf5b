// What the files add to the extension module.
#ifndef HALFSPACE_PYTHON_MODULE_H_
#define HALFSPACE_PYTHON_MODULE_H_

#include <pybind11/pybind11.h>

namespace halfspace::python {

// arrow_column(), which returns a NumPy array of the memory of an object with
// __arrow_c_array__. The array keeps the memory alive.
void DefineArrow(pybind11::module_& module);
void DefineBroadPhase(pybind11::module_& module);
void DefineScan(pybind11::module_& module);
void DefineTree(pybind11::module_& module);

}  // namespace halfspace::python

#endif  // HALFSPACE_PYTHON_MODULE_H_
