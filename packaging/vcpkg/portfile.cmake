# A tag fills REPO and SHA512.
vcpkg_from_github(
  OUT_SOURCE_PATH SOURCE_PATH
  REPO "@REPOSITORY@"
  REF "v${VERSION}"
  SHA512 "@SHA512@"
  HEAD_REF main)
string(COMPARE EQUAL "${VCPKG_LIBRARY_LINKAGE}" dynamic is_shared)
vcpkg_cmake_configure(
  SOURCE_PATH "${SOURCE_PATH}"
  OPTIONS -DHALFSPACE_C=ON "-DHALFSPACE_SHARED=${is_shared}")
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(CONFIG_PATH lib/cmake/halfspace)
vcpkg_fixup_pkgconfig()
file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/debug/include" "${CURRENT_PACKAGES_DIR}/debug/share")
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/LICENSE")
