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
    set(CMAKE_CROSSCOMPILING_EMULATOR "${HALFSPACE_QEMU_AARCH64}")
    # arm64 libc is where an arm64 program looks for it, thanks to Debian's
    # arm64 packages; without them there is only the cross compiler's copy.
    if(NOT EXISTS /lib/ld-linux-aarch64.so.1)
      list(APPEND CMAKE_CROSSCOMPILING_EMULATOR -L /usr/aarch64-linux-gnu)
    endif()
  endif()
endif()
