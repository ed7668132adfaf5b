"""Builds the extension module with CMake, with the options in the environment variable
CMAKE_ARGS. HALFSPACE_HOMEPAGE is the address of the project, which the sources do not know.
pyproject.toml has everything else."""

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = Path(__file__).parent.resolve()


def version():
    header = (ROOT / "include/halfspace/version.h").read_text()
    return re.search(r'HALFSPACE_VERSION_STRING "(.*)"', header).group(1)


def pybind11_options():
    """Where pybind11 is, if it is a Python package, as pip installs it."""
    try:
        import pybind11
    except ImportError:
        return []
    return [f"-Dpybind11_DIR={pybind11.get_cmake_dir()}"]


class CMakeBuild(build_ext):
    def build_extension(self, extension):
        if shutil.which("cmake") is None:
            sys.exit("halfspace: cmake 3.22 or later is needed to build it")
        build = Path(self.build_temp).resolve()
        subprocess.run(
            [
                "cmake",
                f"-S{ROOT}",
                f"-B{build}",
                "-DCMAKE_BUILD_TYPE=Release",
                "-DHALFSPACE_PYTHON=ON",
                "-DHALFSPACE_DIMS=2;3",
                "-DHALFSPACE_INSTALL=OFF",
                f"-DPython_EXECUTABLE={sys.executable}",
                *pybind11_options(),
                *shlex.split(os.environ.get("CMAKE_ARGS", "")),
            ],
            check=True,
        )
        subprocess.run(
            [
                "cmake",
                "--build",
                str(build),
                "--config",
                "Release",
                "--target",
                "halfspace_python",
                "--parallel",
                str(os.cpu_count()),
            ],
            check=True,
        )
        target = Path(self.get_ext_fullpath(extension.name))
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(build / "python/halfspace" / target.name, target)


def urls():
    homepage = os.environ.get("HALFSPACE_HOMEPAGE")
    return {"Homepage": homepage} if homepage else {}


setup(
    version=version(),
    project_urls=urls(),
    ext_modules=[Extension("halfspace._halfspace", [])],
    cmdclass={"build_ext": CMakeBuild},
)
