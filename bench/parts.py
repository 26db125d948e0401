"""What it costs to divide a frame: the processor time of all its parts, each a program of its own, over that of one program.

Usage: parts.py KAIROS [SCENE [--parts N,N,...] [--repeats R] [RENDER OPTION...]]

Prints a table: parts, processor seconds of all, their ratio to the whole frame's, and the share of them that went into loading the scene and
making the shot. The least of R runs (3) of each counts, since others may use the machine; runs of the whole frame and of parts take turns.
"""

import argparse
import os
import pathlib
import re
import subprocess
import sys
import tempfile

parser = argparse.ArgumentParser()
parser.add_argument("kairos")
parser.add_argument("scene", nargs="?", default="out/demo.glb")
parser.add_argument("--parts", default="4,16")
parser.add_argument("--repeats", type=int, default=3)
arguments, options = parser.parse_known_args()
if not options:
    options = ["--frame", "24", "--shutter", "0,0.5", "--size", "1920x1080", "--spp", "64", "--shading", "normal"]


def render(out, *more):
    """Processor seconds, and seconds of loading."""
    command = [arguments.kairos, "render", arguments.scene, *options, "-o", out, *more]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    log = process.stderr.read()
    _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        sys.exit(f"status {status} from {' '.join(map(str, command))}\n{log}")
    return usage.ru_utime + usage.ru_stime, float(re.search(r"in ([0-9.]+) s;", log)[1])


def parts(folder, count):
    spent = [render(folder / f"p{count}.exr", "--part", f"{i}/{count}") for i in range(1, count + 1)]
    for part in (folder / f"p{count}.exr.parts").iterdir():
        part.unlink()
    return sum(cpu for cpu, _ in spent), sum(load for _, load in spent)


counts = [int(count) for count in arguments.parts.split(",")]
best = {count: (float("inf"), 0.0) for count in [1, *counts]}
with tempfile.TemporaryDirectory(prefix="kairos_parts_") as name:
    for _ in range(arguments.repeats):
        best[1] = min(best[1], render(pathlib.Path(name) / "whole.exr"))
        for count in counts:
            best[count] = min(best[count], parts(pathlib.Path(name), count))
print("parts  processor s  ratio  loading")
for count, (cpu, load) in best.items():
    print(f"{count:5}  {cpu:11.2f}  {cpu / best[1][0]:5.3f}  {load / cpu:6.1%}")
