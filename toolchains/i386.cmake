# 32-bit x86.
set(triple i686-linux-gnu)
set(processor i386)
set(cpu -cpu max)  # the default has no SSE4
include("${CMAKE_CURRENT_LIST_DIR}/linux-gnu.cmake")
