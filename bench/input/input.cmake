# The readers of cpuinfo-bench's input files, a library so that the tests can
# link them.
add_library(halfspace_bench_input STATIC
  ${CMAKE_CURRENT_LIST_DIR}/bounds_reader.cc
  ${CMAKE_CURRENT_LIST_DIR}/mesh_reader.cc
  ${CMAKE_CURRENT_LIST_DIR}/text_lines.cc)
target_include_directories(halfspace_bench_input
                           PUBLIC "${CMAKE_CURRENT_LIST_DIR}/../..")
target_link_libraries(halfspace_bench_input PUBLIC ${HALFSPACE_FOR_PROGRAMS})
halfspace_configure_target(halfspace_bench_input)
