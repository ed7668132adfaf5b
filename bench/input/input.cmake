# The readers of cpuinfo-bench's input files, a library so that the tests can
# link them.
find_package(nlohmann_json REQUIRED)
add_library(halfspace_bench_input STATIC
  ${CMAKE_CURRENT_LIST_DIR}/bounds_reader.cc
  ${CMAKE_CURRENT_LIST_DIR}/gltf_accessor.cc
  ${CMAKE_CURRENT_LIST_DIR}/gltf_buffers.cc
  ${CMAKE_CURRENT_LIST_DIR}/gltf_document.cc
  ${CMAKE_CURRENT_LIST_DIR}/gltf_nodes.cc
  ${CMAKE_CURRENT_LIST_DIR}/gltf_reader.cc
  ${CMAKE_CURRENT_LIST_DIR}/input_file.cc
  ${CMAKE_CURRENT_LIST_DIR}/mesh_reader.cc
  ${CMAKE_CURRENT_LIST_DIR}/obj_reader.cc
  ${CMAKE_CURRENT_LIST_DIR}/text_lines.cc)
target_include_directories(halfspace_bench_input
                           PUBLIC "${CMAKE_CURRENT_LIST_DIR}/../..")
target_link_libraries(halfspace_bench_input
  PUBLIC halfspace::halfspace
  PRIVATE nlohmann_json::nlohmann_json)
halfspace_configure_target(halfspace_bench_input)
