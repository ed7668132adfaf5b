# aarch64 Linux with gcc: NEON, SVE and SVE2, chosen at run time.
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
include("${CMAKE_CURRENT_LIST_DIR}/aarch64-linux-gnu.cmake")
