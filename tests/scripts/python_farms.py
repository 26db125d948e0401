"""The examples that render a sequence with dask and with mpi4py: each frame has the bits of `kairos render`.

Usage: python_farms.py PROJECT_ROOT BUILD_DIR, with a Python that has numpy

dask and mpi4py come from a virtual environment in BUILD_DIR, which is made once. Where it cannot be made, this ends with
status 77: skipped. Where there is no mpirun, mpi4py alone is left out.
"""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

PACKAGES = ["dask[distributed]==2026.8.0", "mpi4py==4.1.2"]
root, build = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
place = build / "python_farms"
python, kairos, scene = place / "bin/python", build / "bin/kairos", build / "demo.glb"


def make_environment():
    done = place / "made"
    if done.exists():
        return
    try:
        subprocess.run([sys.executable, "-m", "venv", "--clear", "--system-site-packages", place], check=True, capture_output=True, timeout=120)
        subprocess.run([python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--retries", "1", "--timeout", "15", *PACKAGES], check=True,
                       capture_output=True, timeout=200)
    except (subprocess.SubprocessError, OSError) as problem:
        print(f"skipped: dask and mpi4py cannot be installed here ({problem})")
        sys.exit(77)
    done.touch()


def try_example(folder, name, before):
    out = folder / name
    environment = {**os.environ, "PYTHONPATH": str(build / "lib/python3/dist-packages")}
    done = subprocess.run([*before, root / "examples/farm" / f"{name}_frames.py", scene, out], env=environment, text=True, timeout=120,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    if done.returncode != 0 or done.stdout.count("mean") != 4:
        sys.exit(f"{name}: status {done.returncode}\n{done.stdout}")
    for frame in range(24, 28):
        compared = subprocess.run([kairos, "compare", folder / f"frame_{frame:04}.exr", out / f"frame_{frame:04}.exr"], text=True, stdout=subprocess.PIPE)
        if "MSE 0," not in compared.stdout:
            sys.exit(f"{name}: frame {frame} is another one than the command line's: {compared.stdout}")


make_environment()
with tempfile.TemporaryDirectory(prefix="kairos_farms_") as name:
    folder = pathlib.Path(name)
    subprocess.run([kairos, "render", scene, "-o", folder / "frame_%04d.exr", "--frames", "24-27", "--shutter", "0,0.5", "--size", "160x90", "--spp", "4", "--quiet"],
                   check=True)
    try_example(folder, "dask", [python])
    if shutil.which("mpirun") is None:
        print("mpi4py is left out: there is no mpirun")
    else:
        root_too = ["--allow-run-as-root"] if os.geteuid() == 0 else []
        try_example(folder, "mpi4py", ["mpirun", "--bind-to", "none", "--oversubscribe", "-np", "3", *root_too, python, "-m", "mpi4py.futures"])
