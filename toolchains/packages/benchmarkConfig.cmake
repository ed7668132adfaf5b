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
# Its own CMake files compile and link a program for each of 25 questions, which takes
# Emscripten 3 minutes.
find_package(Threads REQUIRED)
file(GLOB sources "${benchmark_SOURCE_DIR}/src/*.cc")
list(FILTER sources EXCLUDE REGEX "/benchmark_main[.]cc$")
add_library(benchmark STATIC EXCLUDE_FROM_ALL ${sources})
set_target_properties(benchmark PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 0)
target_compile_features(benchmark PRIVATE cxx_std_11)
target_compile_definitions(benchmark
  PUBLIC BENCHMARK_STATIC_DEFINE PRIVATE HAVE_STD_REGEX HAVE_STEADY_CLOCK)
target_include_directories(benchmark SYSTEM PUBLIC "${benchmark_SOURCE_DIR}/include")
target_link_libraries(benchmark PUBLIC Threads::Threads $<$<BOOL:${WIN32}>:shlwapi>)
add_library(benchmark::benchmark ALIAS benchmark)
