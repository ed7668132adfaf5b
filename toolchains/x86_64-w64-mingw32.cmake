# 64-bit Windows with gcc: Debian's mingw-w64 with POSIX threads. Programs run in wine.
include("${CMAKE_CURRENT_LIST_DIR}/packages-of-host.cmake")
set(CMAKE_SYSTEM_NAME Windows)
set(CMAKE_SYSTEM_PROCESSOR x86_64)
set(CMAKE_C_COMPILER x86_64-w64-mingw32-gcc-posix)
set(CMAKE_CXX_COMPILER x86_64-w64-mingw32-g++-posix)
set(CMAKE_RC_COMPILER x86_64-w64-mingw32-windres)
# So that a program needs no DLL of gcc.
set(CMAKE_EXE_LINKER_FLAGS_INIT -static)
set(CMAKE_SHARED_LINKER_FLAGS_INIT -static)
# Debian's command `wine` would ask for 32-bit wine, too.
find_program(HALFSPACE_WINE wine64 PATHS /usr/lib/wine)
if(HALFSPACE_WINE)
  set(CMAKE_CROSSCOMPILING_EMULATOR env WINEDEBUG=-all "WINEPREFIX=${CMAKE_BINARY_DIR}/wine"
      "WINEPATH=Z:${CMAKE_BINARY_DIR}" WINEDLLOVERRIDES=mscoree,mshtml= "${HALFSPACE_WINE}")
endif()
