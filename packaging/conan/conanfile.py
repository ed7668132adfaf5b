"""Conan 2 recipe. A tag fills the address and the checksum of a source archive, which has
the headers of Highway."""

from conan import ConanFile
from conan.tools.cmake import CMake, CMakeToolchain, cmake_layout
from conan.tools.files import copy, get


class HalfspaceConan(ConanFile):
    name = "halfspace"
    version = "0.1.0"
    description = "Broad phases, BVHs and SIMD rejection tests over stored bounding volumes"
    license = "MIT"
    package_type = "library"
    settings = "os", "arch", "compiler", "build_type"
    options = {"shared": [True, False]}
    default_options = {"shared": False}

    def layout(self):
        cmake_layout(self, src_folder="src")

    def source(self):
        get(self, "@URL@", sha256="@SHA256@", strip_root=True)

    def generate(self):
        toolchain = CMakeToolchain(self)
        toolchain.cache_variables["HALFSPACE_C"] = True
        toolchain.cache_variables["HALFSPACE_SHARED"] = bool(self.options.shared)
        toolchain.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        copy(self, "LICENSE", self.source_folder, f"{self.package_folder}/licenses")
        CMake(self).install()

    def package_info(self):
        self.cpp_info.libs = ["halfspace"]
        if self.options.shared:
            self.cpp_info.defines = ["HALFSPACE_SHARED"]
