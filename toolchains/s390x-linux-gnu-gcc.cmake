# s390x Linux with gcc, a big-endian machine: plain code. Programs run under qemu.
include("${CMAKE_CURRENT_LIST_DIR}/packages-of-host.cmake")
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR s390x)
set(CMAKE_C_COMPILER s390x-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER s390x-linux-gnu-g++)
find_program(HALFSPACE_QEMU_S390X qemu-s390x)
if(HALFSPACE_QEMU_S390X)
  # The C library of Debian's cross compiler.
  set(CMAKE_CROSSCOMPILING_EMULATOR "${HALFSPACE_QEMU_S390X}" -L /usr/s390x-linux-gnu)
endif()
