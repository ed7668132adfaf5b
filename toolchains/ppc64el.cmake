# 64-bit POWER, little-endian.
set(triple powerpc64le-linux-gnu)
set(processor ppc64le)
include("${CMAKE_CURRENT_LIST_DIR}/linux-gnu.cmake")
