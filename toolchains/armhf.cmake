# 32-bit ARM whose functions take floats in floating-point registers.
set(triple arm-linux-gnueabihf)
set(processor arm)
include("${CMAKE_CURRENT_LIST_DIR}/linux-gnu.cmake")
