# What both aarch64 toolchains share: Debian's arm64 packages and the emulator.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)

# Debian installs the other architecture's libraries beside the host's.
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(ENV{PKG_CONFIG_LIBDIR}
    "/usr/lib/aarch64-linux-gnu/pkgconfig:/usr/share/pkgconfig")

# On an arm64 machine the tests run as they are.
cmake_host_system_information(RESULT host_processor QUERY OS_PLATFORM)
if(NOT host_processor STREQUAL "aarch64")
  find_program(HALFSPACE_QEMU_AARCH64 qemu-aarch64)
  if(HALFSPACE_QEMU_AARCH64)
    # -L: the loader and libc of the cross compiler's package.
    set(CMAKE_CROSSCOMPILING_EMULATOR
        "${HALFSPACE_QEMU_AARCH64};-L;/usr/aarch64-linux-gnu")
  endif()
endif()
