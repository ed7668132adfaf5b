# 32-bit ARM whose functions take floats in integer registers. Debian's own armel computes
# them in software, which rounds some differences wrongly (dispatch/outward.h).
set(triple arm-linux-gnueabi)
set(processor arm)
foreach(language C CXX)
  set(CMAKE_${language}_FLAGS_INIT "-march=armv6k+fp -mfloat-abi=softfp")
endforeach()
include("${CMAKE_CURRENT_LIST_DIR}/linux-gnu.cmake")
