// What a compiler says of these headers if it reads them as C++14 or older. The
// first headers that the others include begin with this one.
#ifndef HALFSPACE_DETAIL_CXX17_H_
#define HALFSPACE_DETAIL_CXX17_H_

#if defined(_MSVC_LANG) ? _MSVC_LANG < 201703L : __cplusplus < 201703L
#error "halfspace needs C++17 or later: compile with -std=c++17 (/std:c++17)"
// A missing file ends the compilation, so no error of what follows hides this.
#include "halfspace/needs_cxx17.h"
#endif

#endif  // HALFSPACE_DETAIL_CXX17_H_
