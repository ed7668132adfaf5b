# How every target of this project is compiled. Per target, never global, so
# that a project which includes this one keeps its own flags.

function(halfspace_configure_target target)
  target_compile_features(${target} PRIVATE cxx_std_20)
  set_target_properties(${target} PROPERTIES
    CXX_EXTENSIONS OFF
    CXX_VISIBILITY_PRESET hidden
    VISIBILITY_INLINES_HIDDEN ON)
  if(MSVC)
    # Attributes of gcc are ignored, and functions of the C library are used.
    target_compile_options(${target} PRIVATE
      /W4 /wd5030 /fp:precise /bigobj
      $<$<CXX_COMPILER_ID:Clang>:/clang:-ffp-contract=off>)  # clang-cl
    target_compile_definitions(${target} PRIVATE _CRT_SECURE_NO_WARNINGS)
  else()
    # Contraction and fast-math would change answers between compilers and
    # delete the error-free sums; the caller's own flags must not matter.
    target_compile_options(${target} PRIVATE
      -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion
      -fno-fast-math -ffp-contract=off)
    # The registers of x87 keep more digits than a float has.
    if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(i.86|x86|x86_64|AMD64)$" AND
       CMAKE_SIZEOF_VOID_P EQUAL 4 AND NOT EMSCRIPTEN)
      target_compile_options(${target} PRIVATE -msse2 -mfpmath=sse)
    endif()
    # gcc notes that passing wide vectors changed its ABI; no such function
    # leaves a translation unit.
    target_compile_options(${target} PRIVATE
      $<$<CXX_COMPILER_ID:GNU>:-Wno-psabi>)
    # gcc for Windows does not align the stack to vectors of 256 and 512 bits (its bug
    # 54412), where Debian has not patched it.
    if(MINGW AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
      target_compile_options(${target} PRIVATE -Wa,-muse-unaligned-vector-move)
    endif()
    # gcc 12 sees an overlap in every "literal" + std::string (its bug 105651).
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND
       CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
      target_compile_options(${target} PRIVATE -Wno-restrict)
    endif()
    # gcc cannot tell that the destructor of DefaultFpMode takes its address back, where it
    # knows nothing of the functions that change the mode.
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND
       NOT CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64|i.86|aarch64|arm64)$")
      target_compile_options(${target} PRIVATE -Wno-dangling-pointer)
    endif()
  endif()
  if(HALFSPACE_WERROR)
    target_compile_options(${target} PRIVATE $<IF:$<BOOL:${MSVC}>,/WX,-Werror>)
  endif()
endfunction()

# The same for a program in C.
function(halfspace_configure_c_target target)
  set_target_properties(${target} PROPERTIES
    C_STANDARD 11
    C_STANDARD_REQUIRED ON
    C_EXTENSIONS OFF)
  if(NOT MSVC)
    target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic)
  endif()
  if(HALFSPACE_WERROR)
    target_compile_options(${target} PRIVATE $<IF:$<BOOL:${MSVC}>,/WX,-Werror>)
  endif()
endfunction()

# halfspace_require(<package> <option> <debian package>): finds what the option needs, or
# says how to install it. A macro, as find_package() sets variables.
macro(halfspace_require package option debian)
  find_package(${package} QUIET)
  if(NOT ${package}_FOUND)
    message(FATAL_ERROR "halfspace: ${option} needs ${package}, which is not here.\n"
      "On Debian and Ubuntu: apt install ${debian}\n"
      "./test.sh and ./bench.sh install what they need.")
  endif()
endmacro()

# Forbids the compiler's own vectorisation.
function(halfspace_keep_scalar target)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE -fno-tree-vectorize)
  elseif(NOT MSVC)
    target_compile_options(${target} PRIVATE -fno-vectorize
                                             -fno-slp-vectorize)
  endif()
endfunction()

# For sources with kernels for every target. With all sanitizer checks a compiler
# takes many minutes on each; the checks left out are those that look at every
# single pointer, which address checks too, and clang calls that one instead of
# inlining it.
function(halfspace_ease_sanitizers)
  if(NOT CMAKE_CXX_FLAGS MATCHES "-fsanitize=")
    return()
  endif()
  set(options -O1 -g1
    -fno-sanitize=null,alignment,object-size,vptr,bounds,pointer-overflow)
  if(CMAKE_CXX_COMPILER_ID MATCHES "Clang" AND
     CMAKE_CXX_FLAGS MATCHES "address")
    list(APPEND options -fsanitize-address-outline-instrumentation)
  endif()
  set_property(SOURCE ${ARGN} APPEND PROPERTY COMPILE_OPTIONS ${options})
endfunction()
