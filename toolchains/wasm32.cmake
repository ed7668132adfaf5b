# WebAssembly with vectors of 128 bits, by Emscripten: Debian's, or that of EMSCRIPTEN in
# the environment. Programs run in node.
include("${CMAKE_CURRENT_LIST_DIR}/packages-of-host.cmake")
if(DEFINED ENV{EMSCRIPTEN})
  set(emscripten "$ENV{EMSCRIPTEN}")
else()
  set(emscripten /usr/share/emscripten)
endif()
include("${emscripten}/cmake/Modules/Platform/Emscripten.cmake")
# Errors are exceptions in the library.
foreach(language C CXX)
  set(CMAKE_${language}_FLAGS_INIT "-msimd128 -fwasm-exceptions")
endforeach()
