# 32-bit ARM without floating-point registers.
set(triple arm-linux-gnueabi)
set(processor arm)
include("${CMAKE_CURRENT_LIST_DIR}/linux-gnu.cmake")
