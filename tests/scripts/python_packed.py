"""The package as it is installed: in a new virtual environment, by pip without an index, and by CMake into a prefix.

Usage: python_packed.py PROJECT_ROOT BUILD_DIR, with a Python that has numpy, setuptools and wheel. BUILD_DIR is not built again.
"""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

root, build = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
PROGRAM = """
import sys, kairos
assert kairos.__file__.startswith(sys.argv[1]), kairos.__file__
print(kairos.load(sys.argv[2]).shot(frame=24, shutter=(0, 0.5), size=(32, 18)).render(spp=1))
"""


def run(*command, **more):
    clean = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "PIP_"))}
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env={**clean, **more.pop("env", {})}, **more)
    if done.returncode != 0:
        sys.exit(f"status {done.returncode} from {' '.join(map(str, command))}\n{done.stdout}")
    return done.stdout


with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name).resolve()
    # pip leaves what it makes beside the sources.
    for part in ("CMakeLists.txt", "setup.py", "pyproject.toml", "README.md"):
        shutil.copy(root / part, folder)
    shutil.copytree(root / "python/kairos", folder / "python/kairos")
    run(sys.executable, "-m", "venv", "--system-site-packages", folder / "new")
    python = folder / "new/bin/python"
    run(python, "-m", "pip", "install", "--no-index", "--no-build-isolation", ".", cwd=folder, env={"KAIROS_BUILD_DIR": str(build)})
    shown = run(python, "-c", PROGRAM, folder / "new", build / "demo.glb", cwd=folder)
    if "<Image 32x18, channels R G B>" not in shown:
        sys.exit(f"the package of pip printed {shown}")

    run("cmake", "--install", build, "--prefix", folder / "prefix")
    where = next((folder / "prefix/lib").glob("python3*/*-packages"))
    run(sys.executable, "-c", PROGRAM, where, build / "demo.glb", cwd=folder, env={"PYTHONPATH": str(where)})
