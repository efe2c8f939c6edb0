"""Builds the Python module by CMake, as pybind11 recommends: `pip install .`, or, with the packages of Debian and no
index, `pip install --no-build-isolation .`

Poise is compiled into build-python/cmake. The environment variable POISE_BUILD_FOLDER names a build folder of Poise
that is used instead and brought up to date, because compiling all of Poise takes ten minutes.
"""

from __future__ import annotations

import importlib.util
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

SOURCE = Path(__file__).resolve().parent
# What setuptools writes. Its own default, build/, is the build folder of CMake.
WORK = "build-python"


def version() -> str:
    """The version of Poise, which CMakeLists.txt alone says."""
    found = re.search(r"project\(poise VERSION ([0-9.]+)", (SOURCE / "CMakeLists.txt").read_text())
    if found is None:
        raise RuntimeError("CMakeLists.txt: expected project(poise VERSION ...)")
    return found.group(1)


def configure(build: Path) -> None:
    """Let CMake write a build folder for this Python, with the module alone in it."""
    options = [
        "-DCMAKE_BUILD_TYPE=Release",
        "-DCMAKE_CXX_FLAGS_RELEASE=-O2 -DNDEBUG",
        "-DCMAKE_UNITY_BUILD=ON",
        "-DCMAKE_UNITY_BUILD_BATCH_SIZE=32",
        f"-DPython_EXECUTABLE={sys.executable}",
        "-DPOISE_BUILD_APP=OFF",
        "-DPOISE_BUILD_BENCHMARKS=OFF",
        "-DPOISE_BUILD_TESTS=OFF",
        "-DPOISE_WITH_MPI=OFF",
    ]
    # The pybind11 of an index is a Python package, which CMake does not look into.
    if importlib.util.find_spec("pybind11") is not None:
        import pybind11

        options.append(f"-Dpybind11_DIR={pybind11.get_cmake_dir()}")
    if shutil.which("ninja") is not None:
        options.append("-GNinja")
    subprocess.run(["cmake", "-S", str(SOURCE), "-B", str(build), *options], check=True)


class BuildByCMake(build_ext):
    """Compiles poise._poise with CMake and puts it, with the examples, where setuptools collects the package."""

    def build_extension(self, ext: Extension) -> None:
        given = os.environ.get("POISE_BUILD_FOLDER")
        build = Path(given).resolve() if given else SOURCE / WORK / "cmake"
        if not (build / "CMakeCache.txt").exists():
            if given:
                raise RuntimeError(f"POISE_BUILD_FOLDER: expected a build folder of Poise, found {build}")
            configure(build)
        subprocess.run(
            ["cmake", "--build", str(build), "--parallel", str(os.cpu_count()), "--target", "poise_python"], check=True
        )
        target = Path(self.get_ext_fullpath(ext.name))
        built = build / "python" / "poise" / target.name
        if not built.exists():
            raise RuntimeError(f"expected {built}: is this folder that of another Python than {sys.executable}?")
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(built, target)
        # The examples of poise.example(), which are beside the package in the sources.
        shutil.copytree(SOURCE / "datasets", target.parent / "datasets", dirs_exist_ok=True)


(SOURCE / WORK).mkdir(exist_ok=True)
# Files of the package that are gone would be installed from what was collected before.
for collected in (SOURCE / WORK).glob("lib*"):
    shutil.rmtree(collected)
setup(
    version=version(),
    ext_modules=[Extension("poise._poise", sources=[])],
    cmdclass={"build_ext": BuildByCMake},
    options={"build": {"build_base": WORK}, "egg_info": {"egg_base": WORK}},
)
