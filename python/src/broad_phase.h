// The broad phase of a Python object.
#ifndef HALFSPACE_PYTHON_BROAD_PHASE_H_
#define HALFSPACE_PYTHON_BROAD_PHASE_H_

#include <pybind11/pybind11.h>

namespace halfspace::python {

// Adds the class BroadPhase to the module.
void DefineBroadPhase(pybind11::module_& module);

}  // namespace halfspace::python

#endif  // HALFSPACE_PYTHON_BROAD_PHASE_H_
