// The flat scan of a Python object.
#ifndef HALFSPACE_PYTHON_SCAN_H_
#define HALFSPACE_PYTHON_SCAN_H_

#include <pybind11/pybind11.h>

namespace halfspace::python {

// Adds the class Scan to the module.
void DefineScan(pybind11::module_& module);

}  // namespace halfspace::python

#endif  // HALFSPACE_PYTHON_SCAN_H_
