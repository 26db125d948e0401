"""Parts of a picture on the ranks of an MPI job over TCP, one of which is killed; then the same command again.

Usage: mpi.py PROJECT_ROOT KAIROS KAIROS_MPI
"""

import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time

root, kairos, kairos_mpi = (pathlib.Path(argument) for argument in sys.argv[1:4])
OPTIONS = [str(root / "scenes/star/star.json"), "--size", "160x90", "--tc-rays", "16", "--threads", "1"]


def fail(message):
    sys.exit(f"mpi: {message}")


def job(folder, *more):
    command = ["mpirun", "--bind-to", "none", "--oversubscribe", "-np", "3", "--mca", "btl", "self,tcp", "--mca", "btl_tcp_if_include", "lo"]
    if os.geteuid() == 0:
        command.append("--allow-run-as-root")
    return [*command, kairos_mpi, "--kairos", kairos, *more]


def ranks_of(process):
    """Process ids of the ranks that mpirun has started."""
    children = subprocess.run(["ps", "-o", "pid=,comm=", "--ppid", str(process)], text=True, stdout=subprocess.PIPE).stdout.split("\n")
    return [int(line.split()[0]) for line in children if "kairos-mpi" in line]


def main():
    folder = pathlib.Path(tempfile.mkdtemp(prefix="kairos_mpi_"))
    try:
        render = ["--parts", "12", "render", *OPTIONS, "-o", folder / "parts.exr"]
        subprocess.run([kairos, "render", *OPTIONS, "--quiet", "-o", folder / "whole.exr"], check=True)
        running = subprocess.Popen(job(folder, *render), stderr=subprocess.PIPE, stdout=subprocess.PIPE)
        end = time.time() + 60
        while not list(folder.glob("parts.exr.parts/*.exr")) and time.time() < end:
            time.sleep(0.005)
        ranks = ranks_of(running.pid)
        if len(ranks) == 3:
            os.kill(ranks[-1], signal.SIGKILL)
        running.communicate(timeout=60)
        if len(ranks) == 3 and running.returncode == 0 and not (folder / "parts.exr").exists():
            fail("a job that lost a rank says that all is well")
        again = subprocess.run(job(folder, *render), stderr=subprocess.STDOUT, stdout=subprocess.PIPE, text=True, timeout=120)
        if again.returncode != 0:
            fail("the second run fails:\n" + again.stdout)
        compared = subprocess.run([kairos, "compare", folder / "whole.exr", folder / "parts.exr"], text=True, stdout=subprocess.PIPE)
        print(compared.stdout)
        if "MSE 0," not in compared.stdout:
            fail("the merged picture is another one")
        if (folder / "parts.exr.parts").exists():
            fail("parts are left behind")
        wrong = subprocess.run(job(folder, "render", "absent.json", "-o", folder / "b.exr"), stderr=subprocess.PIPE, text=True, timeout=120)
        if wrong.returncode == 0 or "12 of 12 parts failed" not in wrong.stderr or (folder / "b.exr").exists():
            fail(f"a scene that is not there is no error: {wrong.stderr}")
    finally:
        shutil.rmtree(folder, ignore_errors=True)


main()
