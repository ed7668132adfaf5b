# The kernels, as a source file for each set that a program may link alone.

# A copy of two neighbouring fields as one vector waits for the stores that just
# wrote them: 4 ns in a call that takes 25.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  set(scalar_copies -fno-tree-slp-vectorize)
elseif(NOT MSVC)
  set(scalar_copies -fno-slp-vectorize)
endif()
set_property(SOURCE dispatch/scan/reject.cc dispatch/scan/reject_many.cc
  APPEND PROPERTY COMPILE_OPTIONS ${scalar_copies})

# halfspace_add_made(<template> <name> [OPTION...]): adds <template>.cc.in, with
# this scope's variables, as <name>.cc.
function(halfspace_add_made template name)
  set(source "${name}.cc")
  set(file "${PROJECT_BINARY_DIR}/kernels/${source}")
  configure_file("${PROJECT_SOURCE_DIR}/${template}.cc.in" "${file}" @ONLY)
  if(HALFSPACE_UNITY AND template STREQUAL "kernels/table" AND name MATCHES "^(.*)_[2-5]$")
    set(file "${PROJECT_BINARY_DIR}/kernels/${CMAKE_MATCH_1}_of_all.cc")
    set_property(TARGET halfspace APPEND PROPERTY HALFSPACE_UNITY_FILES "${file}")
    set_property(SOURCE "${file}" APPEND PROPERTY HALFSPACE_TABLES "${source}")
  endif()
  target_sources(halfspace PRIVATE "${file}")
  set_property(SOURCE "${file}" APPEND PROPERTY COMPILE_OPTIONS ${ARGN})
  # The others have no code per target.
  if(template MATCHES "^kernels")
    halfspace_ease_sanitizers("${file}")
  endif()
endfunction()

# halfspace_add_table(<name> <key> <entry> [OPTION...]): adds <name>.cc, which defines
# the table of this scope's `table` and of the key. An element is a struct of type
# `kernels`. The expression `entry` makes that of one target. The list `inl` has the
# headers of the functions in it.
function(halfspace_add_table name key entry)
  list(TRANSFORM inl REPLACE "(.+)" "#include \"\\1\"")
  list(JOIN inl "\n" inl)
  halfspace_add_made(kernels/table "${name}" ${ARGN})
endfunction()

target_include_directories(halfspace PRIVATE "${PROJECT_BINARY_DIR}/kernels")

# In d dimensions a box has d axes, and the other shapes have d + 1: a shape of
# another number adds that here.
set(HALFSPACE_DIMS "2;3" CACHE STRING
    "Dimensions to compile: a list of 2, 3 and 4")
if(NOT HALFSPACE_DIMS MATCHES "^[234](;[234])*$")
  message(FATAL_ERROR "halfspace: HALFSPACE_DIMS is a list of 2, 3 and 4, "
                      "not \"${HALFSPACE_DIMS}\".")
endif()
set(all_axes)
foreach(dims IN LISTS HALFSPACE_DIMS)
  math(EXPR axes "${dims} + 1")
  list(APPEND all_axes ${dims} ${axes})
endforeach()
list(REMOVE_DUPLICATES all_axes)
# Only boxes have doubles.
set(axes_of_double ${all_axes})
list(REMOVE_ITEM axes_of_double 5)
foreach(element float std::int8_t std::int16_t)
  set("axes_of_${element}" ${all_axes})
endforeach()

set(kernels TargetKernels)
set(header kernels/scan/kernel_table.h)
set(inl kernels/scan/stages-inl.h)
set(table ScanKernelsOf)
set(parameters "std::size_t kAxes, typename T")
set(arguments "kAxes, T")
foreach(element float double std::int8_t std::int16_t)
  set(declarations "extern template struct ElementKernels<${element}>;")
  string(REGEX REPLACE "std::|_t" "" element_name "${element}")
  halfspace_add_made(kernels/scan/kernels_of_element "scan_${element_name}"
    ${scalar_copies})
  foreach(axes IN LISTS "axes_of_${element}")
    halfspace_add_table("scan_${element_name}_${axes}" "${axes}, ${element}"
      "MakeKernels<${axes}, ${element}>()" ${scalar_copies})
  endforeach()
endforeach()
set(declarations)

# A builder and its file.
set(kernels FitKernels)
set(header kernels/fit_many/kernel_table.h)
set(table FitKernelsOf)
set(parameters "int kSource, int kDims")
set(arguments "kSource, kDims")
foreach(source_name Boxes Spheres Triangles PointSets)
  string(REGEX REPLACE "(.)([A-Z])" "\\1_\\2" file_name "${source_name}")
  string(TOLOWER "${file_name}" file_name)
  # Boxes take 0.65 to 0.75 of the time with -O3, spheres 0.7 to 0.9, in three
  # fifths of the code. Triangles in 3 dimensions take 1.3 times as long.
  set(optimised)
  if(source_name MATCHES "Boxes|Spheres" AND NOT MSVC)
    set(optimised $<$<CONFIG:Release>:-O2>)
  endif()
  foreach(dims IN LISTS HALFSPACE_DIMS)
    set(inl "kernels/fit_many/${file_name}-inl.h")
    halfspace_add_table("fit_${file_name}_${dims}"
      "kFit${source_name}, ${dims}" "{&Fit${source_name}<${dims}>}"
      ${optimised})
  endforeach()
endforeach()

# Bvh worlds have 2 or 3 dimensions.
set(parameters "std::size_t kAxes")
set(arguments kAxes)
foreach(axes IN LISTS all_axes)
  if(axes LESS 5)
    set(header kernels/bvh/kernel_table.h)
    set(inl kernels/bvh/walk-inl.h)
    set(kernels BvhKernels)
    set(table BvhKernelsOf)
    halfspace_add_table("bvh_walk_${axes}" ${axes} "MakeBvhKernels<${axes}>()"
      ${scalar_copies})
    set(header halfspace/detail/bvh.h)
    set(inl kernels/bvh/pairs-inl.h)
    set(kernels BvhPairKernels)
    set(table BvhPairKernelsOf)
    halfspace_add_table("bvh_pairs_${axes}" ${axes} "{&JoinPairs<${axes}>}"
      ${scalar_copies})
  endif()
endforeach()

# For bounds with any planes.
set(table KernelsOfAll)
set(parameters "typename Kernels")
set(arguments Kernels)
set(kernels TargetKernels)
set(header kernels/scan/half_spaces.h)
set(inl kernels/scan/half_spaces-inl.h)
halfspace_add_table(scan_half_spaces TargetKernels "MakeHalfSpaceKernels()")
set(kernels BvhNearestKernels)
set(header kernels/bvh/nearest.h)
set(inl kernels/bvh/cast-inl.h kernels/bvh/nearest-inl.h)
halfspace_add_table(bvh_nearest BvhNearestKernels "{&FindNearest, &CastLine}")
set(kernels MeshKernels)
set(header kernels/bvh/mesh.h)
set(inl kernels/bvh/mesh-inl.h)
halfspace_add_table(bvh_mesh MeshKernels "{&CastAtMesh, &FindNearestOfMesh}")
set(kernels BvhShapeKernels)
set(header kernels/bvh/shape_query.h)
set(inl kernels/bvh/shapes-inl.h kernels/bvh/walk-inl.h)
# As fast as with -O3, in two thirds of the code.
set(optimised)
if(NOT MSVC)
  set(optimised $<$<CONFIG:Release>:-O2>)
endif()
halfspace_add_table(bvh_shapes BvhShapeKernels
  "{{&RunWalk<BallQuery, true>, &RunWalk<BallQuery, false>},
    {&RunWalk<LineQuery, true>, &RunWalk<LineQuery, false>},
    {&RunWalk<HalfSpacesQuery, true>, &RunWalk<HalfSpacesQuery, false>}}"
  ${optimised})

# The tables of all axes as one source, which Highway includes once for each target.
get_target_property(files halfspace HALFSPACE_UNITY_FILES)
if(files)
  list(REMOVE_DUPLICATES files)
  foreach(file IN LISTS files)
    get_filename_component(name "${file}" NAME)
    get_property(tables SOURCE "${file}" PROPERTY HALFSPACE_TABLES)
    list(TRANSFORM tables REPLACE "(.+)" "#include \"\\1\"")
    list(JOIN tables "\n" tables)
    file(CONFIGURE OUTPUT "${file}" CONTENT "#define HALFSPACE_UNITY
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE \"${name}\"
${tables}
")
  endforeach()
endif()

# Highway 1.0.3 has no vectors of doubles on WebAssembly: the kernels with doubles are
# plain code there. Each list of kernels has one entry, whatever it is called.
if(EMSCRIPTEN)
  set(words "${PROJECT_BINARY_DIR}/kernels/words_of_doubles.cc")
  file(CONFIGURE OUTPUT "${words}" CONTENT "#include \"kernels/scan/words.cc\"\n")
  target_sources(halfspace PRIVATE "${words}")
  get_target_property(sources halfspace SOURCES)
  list(FILTER sources INCLUDE REGEX
       "/(scan_double|words_of_doubles|fit_spheres|fit_triangles|fit_point_sets)")
  set_property(SOURCE ${sources} APPEND PROPERTY COMPILE_OPTIONS
    -UHWY_COMPILE_ONLY_STATIC -DHWY_COMPILE_ONLY_SCALAR)
endif()

# The unchecked calls (kernels.h).
set(axes_bits 0)
foreach(axes IN LISTS all_axes)
  math(EXPR axes_bits "${axes_bits} | (1 << ${axes})")
endforeach()
foreach(element float double)
  set(suffix "")
  set(has_d 1)
  if(element STREQUAL "double")
    set(suffix "_of_doubles")
    set(has_d 0)
  endif()
  halfspace_add_made(dispatch/scan/kernels_of "kernels_of_${element}")
  foreach(axes IN LISTS "axes_of_${element}")
    math(EXPR dims "${axes} - 1")
    halfspace_add_made(dispatch/scan/unchecked_of_axes "unchecked_${element}_${axes}"
      ${scalar_copies})
  endforeach()
endforeach()
