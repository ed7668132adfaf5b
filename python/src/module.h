// What the files add to the extension module.
#ifndef HALFSPACE_PYTHON_MODULE_H_
#define HALFSPACE_PYTHON_MODULE_H_

#include <pybind11/pybind11.h>

namespace halfspace::python {

void DefineBroadPhase(pybind11::module_& module);
void DefineScan(pybind11::module_& module);
void DefineTree(pybind11::module_& module);

}  // namespace halfspace::python

#endif  // HALFSPACE_PYTHON_MODULE_H_
