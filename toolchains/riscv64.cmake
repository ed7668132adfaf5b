# 64-bit RISC-V.
set(triple riscv64-linux-gnu)
set(processor riscv64)
include("${CMAKE_CURRENT_LIST_DIR}/linux-gnu.cmake")
