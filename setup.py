"""Builds the Python package: CMake makes the module and the library, setuptools packs them. pyproject.toml says the rest.

KAIROS_BUILD_DIR names a build tree in which they are already, made with -DKAIROS_PYTHON=ON for the same Python.
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = pathlib.Path(__file__).resolve().parent


def configure(tree: pathlib.Path) -> None:
    options = ["-DCMAKE_BUILD_TYPE=Release", "-DKAIROS_PYTHON=ON", "-DKAIROS_BUILD_TESTS=OFF", "-DKAIROS_BUILD_BENCH=OFF",
               "-DCMAKE_UNITY_BUILD=ON", "-DCMAKE_UNITY_BUILD_BATCH_SIZE=12", f"-DPython3_EXECUTABLE={sys.executable}"]
    try:
        import pybind11  # one that was installed for this build; otherwise CMake finds the system's

        options.append(f"-Dpybind11_DIR={pybind11.get_cmake_dir()}")
    except ImportError:
        pass
    if shutil.which("ninja"):
        options += ["-G", "Ninja"]
    if shutil.which("ccache"):
        options.append("-DCMAKE_CXX_COMPILER_LAUNCHER=ccache")
    subprocess.run(["cmake", "-S", ROOT, "-B", tree, *options], check=True)


class CMakeBuild(build_ext):
    def build_extension(self, extension: Extension) -> None:
        given = os.environ.get("KAIROS_BUILD_DIR")
        tree = pathlib.Path(given or self.build_temp).resolve()
        if not given:
            configure(tree)
            subprocess.run(["cmake", "--build", tree, "--target", "kairos_python", "--parallel", str(os.cpu_count() or 1)], check=True)
        target = pathlib.Path(self.get_ext_fullpath(extension.name))
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(tree / "lib/python3/dist-packages/kairos" / target.name, target)
        library = next((tree / "lib").glob("libkairos.so.[0-9]"))
        shutil.copy(library, target.parent / library.name)


setup(version=re.search(r"project\(kairos VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text())[1],
      ext_modules=[Extension("kairos._kairos", [])], cmdclass={"build_ext": CMakeBuild})
