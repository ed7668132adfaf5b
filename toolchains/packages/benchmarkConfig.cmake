# Debian has no library for another system, so it is built from the sources of its package.
if(TARGET benchmark::benchmark)
  return()
endif()
# They are beside the package for this system.
execute_process(COMMAND apt-get download --print-uris libbenchmark-dev
  OUTPUT_VARIABLE sources ERROR_QUIET)
string(REGEX REPLACE "^'([^']*/).*$" "\\1benchmark_1.7.1.orig.tar.gz" sources "${sources}")
include(FetchContent)
FetchContent_Declare(benchmark
  URL "${sources}"
  URL_HASH SHA256=6430e4092653380d9dc4ccb45a1e2dc9259d581f4866dc0759713126056bc1d7
  DOWNLOAD_EXTRACT_TIMESTAMP OFF)
FetchContent_Populate(benchmark)
foreach(option TESTING WERROR INSTALL)
  set(BENCHMARK_ENABLE_${option} OFF CACHE BOOL "")
endforeach()
add_subdirectory("${benchmark_SOURCE_DIR}" "${benchmark_BINARY_DIR}" EXCLUDE_FROM_ALL SYSTEM)
