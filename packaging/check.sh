#!/usr/bin/env bash
# Packs the sources, and installs them by the steps of each recipe, without a network. Small
# stand-ins take the place of the functions of vcpkg, Conan and Homebrew, which Debian does
# not have. Ends with a program in C that is linked with each installation.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
source "$root/scripts/steps.sh"
source "$root/scripts/packages.sh"
install_packages cmake gcc g++ libhwy-dev pkg-config python3 ruby

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export work
mkdir "$work/bin" "$work/sources"
"$root/packaging/source_archive.py" "$work/sources.tar.gz"
tar -xzf "$work/sources.tar.gz" -C "$work/sources" --strip-components=1
export recipes="$work/sources/packaging"

# Compiles as little as possible.
cat >"$work/bin/cmake" <<END
#!/bin/sh
if [ "\$1" = -S ]; then
  set -- "\$@" -DHALFSPACE_ONLY_SCALAR=ON -DHALFSPACE_UNITY=ON -DCMAKE_CXX_FLAGS_RELEASE=-O0 "-DHALFSPACE_DIMS=2;3"
fi
exec $(command -v cmake) "\$@"
END
chmod +x "$work/bin/cmake"
export PATH="$work/bin:$PATH" CMAKE_BUILD_PARALLEL_LEVEL=2

cat >"$work/vcpkg.cmake" <<'END'
set(work $ENV{work})
set(VERSION 0.1.0)
set(VCPKG_LIBRARY_LINKAGE static)
set(CURRENT_PACKAGES_DIR ${work}/vcpkg)
function(vcpkg_from_github)
  cmake_parse_arguments(PARSE_ARGV 0 arg "" "OUT_SOURCE_PATH;REPO;REF;SHA512;HEAD_REF" "")
  set(${arg_OUT_SOURCE_PATH} ${work}/sources PARENT_SCOPE)
endfunction()
function(vcpkg_cmake_configure)
  cmake_parse_arguments(PARSE_ARGV 0 arg "" SOURCE_PATH OPTIONS)
  execute_process(COMMAND cmake -S ${arg_SOURCE_PATH} -B ${work}/vcpkg-build
    -DCMAKE_INSTALL_PREFIX=${CURRENT_PACKAGES_DIR} ${arg_OPTIONS} COMMAND_ERROR_IS_FATAL ANY)
endfunction()
function(vcpkg_cmake_install)
  execute_process(COMMAND cmake --build ${work}/vcpkg-build --target install COMMAND_ERROR_IS_FATAL ANY)
endfunction()
function(vcpkg_cmake_config_fixup CONFIG_PATH path)
  file(READ "${CURRENT_PACKAGES_DIR}/${path}/halfspaceConfig.cmake" must_exist)
endfunction()
function(vcpkg_fixup_pkgconfig)
  file(READ "${CURRENT_PACKAGES_DIR}/lib/pkgconfig/halfspace.pc" must_exist)
endfunction()
function(vcpkg_install_copyright FILE_LIST file)
  file(READ "${file}" must_exist)
endfunction()
include($ENV{recipes}/vcpkg/portfile.cmake)
END

cat >"$work/conan.py" <<'END'
import json, os, pathlib, shutil, subprocess, sys, types
work = os.environ["work"]
recipes = pathlib.Path(os.environ["recipes"])
class ConanFile:
    source_folder, package_folder = f"{work}/sources", f"{work}/conan"
    cpp_info = types.SimpleNamespace()
variables = {}
class Toolchain:
    def __init__(self, _): self.cache_variables = variables
    def generate(self): pass
class CMake:
    def __init__(self, recipe): self.prefix = recipe.package_folder
    def run(self, *words): subprocess.run(["cmake", *words], check=True)
    def configure(self):
        options = [f"-D{name}={value}" for name, value in variables.items()]
        self.run("-S", f"{work}/sources", "-B", f"{work}/conan-build", f"-DCMAKE_INSTALL_PREFIX={self.prefix}", *options)
    def build(self): self.run("--build", f"{work}/conan-build")
    def install(self): self.run("--install", f"{work}/conan-build")
def copy(_, name, source, target):
    os.makedirs(target)
    shutil.copy(f"{source}/{name}", target)
for name, members in {
    "conan": {"ConanFile": ConanFile}, "conan.tools": {},
    "conan.tools.cmake": {"CMake": CMake, "CMakeToolchain": Toolchain, "cmake_layout": lambda *_, **__: None},
    "conan.tools.files": {"copy": copy, "get": lambda *_, **__: None},
}.items():
    sys.modules[name] = types.ModuleType(name)
    vars(sys.modules[name]).update(members)
sys.path.insert(0, str(recipes / "conan"))
from conanfile import HalfspaceConan
recipe = HalfspaceConan()
recipe.options = types.SimpleNamespace(**recipe.default_options)
for step in ["layout", "source", "generate", "build", "package", "package_info"]:
    getattr(recipe, step)()
assert json.loads((recipes / "vcpkg/vcpkg.json").read_text())["version"] == recipe.version
END

cat >"$work/homebrew.rb" <<'END'
require "pathname"
Work = Pathname(ENV.fetch("work"))
def ENV.cc = "cc"
class Formula
  %i[desc homepage url sha256 license depends_on].each { |name| define_singleton_method(name) { |*| } }
  def self.test(&steps) = define_method(:run_test, &steps)
  def prefix = Work/"homebrew"
  def include = prefix/"include"
  def lib = prefix/"lib"
  def testpath = Work
  def version = "0.1.0"
  def std_cmake_args = ["-DCMAKE_INSTALL_PREFIX=#{prefix}", "-DCMAKE_INSTALL_LIBDIR=lib"]
  def system(*words) = Kernel.system(*words) || abort(words.join(" "))
  def shell_output(command) = `LD_LIBRARY_PATH=#{lib} #{command}`
  def assert_equal(a, b) = a == b || abort("#{a} != #{b}")
end
load "#{ENV.fetch("recipes")}/homebrew/halfspace.rb"
Dir.chdir(Work/"sources") { Halfspace.new.install }
Dir.chdir(Work) { Halfspace.new.run_test }
END

without_network=()
if unshare -n true 2>/dev/null; then without_network=(unshare -n); fi
step "vcpkg" "${without_network[@]}" cmake -P "$work/vcpkg.cmake"
step "Conan" "${without_network[@]}" python3 "$work/conan.py"
step "Homebrew" "${without_network[@]}" ruby "$work/homebrew.rb"
for name in vcpkg conan homebrew; do
  folder=$work/$name
  flags=$(PKG_CONFIG_PATH="$folder/lib/pkgconfig" pkg-config --cflags --libs --static halfspace)
  # shellcheck disable=SC2086
  cc "$root/examples/quick_start.c" $flags -o "$folder/program"
  LD_LIBRARY_PATH=$folder/lib "$folder/program"
done
