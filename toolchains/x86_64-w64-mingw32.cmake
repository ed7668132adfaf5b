# 64-bit Windows with gcc: Debian's mingw-w64 with POSIX threads.
include("${CMAKE_CURRENT_LIST_DIR}/highway-of-host.cmake")
set(CMAKE_SYSTEM_NAME Windows)
set(CMAKE_SYSTEM_PROCESSOR x86_64)
set(CMAKE_C_COMPILER x86_64-w64-mingw32-gcc-posix)
set(CMAKE_CXX_COMPILER x86_64-w64-mingw32-g++-posix)
set(CMAKE_RC_COMPILER x86_64-w64-mingw32-windres)
# So that a program needs no DLL of gcc.
set(CMAKE_EXE_LINKER_FLAGS_INIT -static)
