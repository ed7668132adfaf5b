# Debian has no library for another system, so it is built from the sources of its package.
if(TARGET benchmark::benchmark)
  return()
endif()
include(FetchContent)
FetchContent_Declare(benchmark
  URL http://deb.debian.org/debian/pool/main/b/benchmark/benchmark_1.7.1.orig.tar.gz
  URL_HASH SHA256=6430e4092653380d9dc4ccb45a1e2dc9259d581f4866dc0759713126056bc1d7
  DOWNLOAD_EXTRACT_TIMESTAMP OFF)
FetchContent_GetProperties(benchmark)
if(NOT benchmark_POPULATED)
  FetchContent_Populate(benchmark)
endif()
foreach(option TESTING WERROR INSTALL)
  set(BENCHMARK_ENABLE_${option} OFF CACHE BOOL "")
endforeach()
add_subdirectory("${benchmark_SOURCE_DIR}" "${benchmark_BINARY_DIR}" EXCLUDE_FROM_ALL SYSTEM)
