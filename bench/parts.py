"""What it costs to divide a frame: the processor time of all its parts, each a program of its own or all of them handed to one that keeps the
scene (--part -, as a rank of kairos-mpi does), over that of one program that renders the whole.

Usage: parts.py KAIROS [SCENE [--parts N,N,...] [--repeats R] [RENDER OPTION...]]

Prints a table: parts, processor seconds of all, their ratio to the whole frame's, and the share that went into loading the scene and
making the shot; then the first two again where one program renders all parts. The least of R runs (3) of each counts, since others may use the machine; runs of the whole frame and of parts take turns.
"""

import argparse
import os
import pathlib
import re
import shutil
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


def render(out, *more, told=""):
    """Processor seconds, and seconds of loading. told: on standard input."""
    command = [arguments.kairos, "render", arguments.scene, *options, "-o", out, *more]
    process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    process.stdin.write(told)
    process.stdin.close()
    log = process.stderr.read()
    _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        sys.exit(f"status {status} from {' '.join(map(str, command))}\n{log}")
    return usage.ru_utime + usage.ru_stime, float(re.search(r"in ([0-9.]+) s;", log)[1])


def parts(folder, count):
    """Processor seconds of the parts, of loading, and of the parts by one program."""
    out, numbers = folder / "parts.exr", [f"{i}/{count}" for i in range(1, count + 1)]
    spent = [render(out, "--part", number) for number in numbers]
    shutil.rmtree(f"{out}.parts")
    kept, _ = render(out, "--part", "-", told="\n".join(numbers) + "\n")
    shutil.rmtree(f"{out}.parts")
    return sum(cpu for cpu, _ in spent), sum(load for _, load in spent), kept


counts = [int(count) for count in arguments.parts.split(",")]
never = float("inf")
best = {count: (never, never, never) for count in [1, *counts]}
with tempfile.TemporaryDirectory(prefix="kairos_parts_") as name:
    for _ in range(arguments.repeats):
        whole, loading = render(pathlib.Path(name) / "whole.exr")
        best[1] = tuple(map(min, best[1], (whole, loading, whole)))
        for count in counts:
            best[count] = tuple(map(min, best[count], parts(pathlib.Path(name), count)))
print("parts  processor s  ratio  loading  one program's s  ratio")
for count, (cpu, load, kept) in best.items():
    print(f"{count:5}  {cpu:11.2f}  {cpu / best[1][0]:5.3f}  {load / cpu:6.1%}  {kept:15.2f}  {kept / best[1][0]:5.3f}")
