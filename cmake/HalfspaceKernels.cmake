# The kernels, as a source file for each set that a program may link alone. All
# sets are made from the templates next to the kernels.

# halfspace_add_kernels(<template> <name>): adds kernels/<template>.cc.in, with
# this scope's variables, as <name>.cc.
function(halfspace_add_kernels template name)
  set(source "${name}.cc")
  set(file "${PROJECT_BINARY_DIR}/kernels/${source}")
  configure_file("${PROJECT_SOURCE_DIR}/kernels/${template}.cc.in" "${file}" @ONLY)
  target_sources(halfspace PRIVATE "${file}")
  halfspace_ease_sanitizers("${file}")
endfunction()

target_include_directories(halfspace PRIVATE "${PROJECT_BINARY_DIR}/kernels")

foreach(element float double std::int8_t std::int16_t)
  string(REGEX REPLACE "std::|_t" "" element_name "${element}")
  halfspace_add_kernels(scan/kernels_of_element "scan_${element_name}")
  foreach(axes 2 3 4 5)
    halfspace_add_kernels(scan/kernels_of_axes "scan_${element_name}_${axes}")
  endforeach()
endforeach()
