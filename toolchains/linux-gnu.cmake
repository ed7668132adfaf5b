# What the toolchains of Debian's other machines share: gcc for the triple, and qemu's
# emulator of the processor, which programs run under.
include("${CMAKE_CURRENT_LIST_DIR}/packages-of-host.cmake")
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR ${processor})
set(CMAKE_C_COMPILER ${triple}-gcc)
set(CMAKE_CXX_COMPILER ${triple}-g++)
find_program(HALFSPACE_QEMU qemu-${processor})
if(HALFSPACE_QEMU)
  # The C library of Debian's cross compiler.
  set(CMAKE_CROSSCOMPILING_EMULATOR "${HALFSPACE_QEMU}" ${cpu} -L /usr/${triple})
endif()
