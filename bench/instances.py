#!/usr/bin/env python3
"""Measures what it costs to share shapes that are placed many times, and what to copy them, and finds from it where
`--instances auto` goes over from one to the other: the constants of src/scene/instancing.cpp.

    bench/instances.py BUILD OUT [--quick]    measures, and writes OUT/instances.csv
    bench/instances.py --fit FILE.csv         the constants that its numbers give

BUILD: a folder with the programs built, as build/release. Needs nothing but Python's standard library.

Scenes are the garden, two hundred trees of the forest, and half a million triangles of balls with 20, 80, 320 or 1280 each.
Each is rendered from copies and from shared shapes (16 time-continuous rays in a pixel of some rows of 960x540, normals; one
thread, processor time), and loaded and prepared for a picture of one pixel.
"""

import argparse
import math
import os
import pathlib
import random
import re
import statistics
import subprocess
import sys

sys.dont_write_bytecode = True
ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / "bench"), str(ROOT / "tools")]

from jobs import read_rows, write_rows  # noqa: E402
from scenes.native import Mesh, Scene  # noqa: E402
from scenes.swarm import ball  # noqa: E402

WIDTH, HEIGHT, RAYS = 960, 540, 16
BALLS_TOGETHER = 1 << 19  # triangles
SPLITS = (0, 1, 2, 3)
# What copies may take at most, whatever time they save: discrete rays through them are slower.
MOST_BYTES = 1 << 28
# Sharing a shape must save so much of what it takes to load, build and prepare its copies.
LEAST_SAVED = 0.25


def make_balls(folder, splits):
    """Balls of one shape, anywhere in a cloud that the camera passes."""
    rng = random.Random(20)
    points, triangles = ball(splits)
    scene = Scene(folder, WIDTH, HEIGHT)
    scene.camera(45, ((0.0, 0.0, 9.0), (0.0, 0.0, 0.0)), ((0.12, 0.0, 9.0), (0.12, 0.0, 0.0)))
    shape = Mesh("ball", scene.material("ball"))
    shape.add([points], triangles)
    count = BALLS_TOGETHER // len(triangles)
    size = 3.0 / math.sqrt(count)  # they cover as much, however many
    places = []
    for _ in range(count):
        x, y, z = (4 * rng.uniform(-1, 1), 2.5 * rng.uniform(-1, 1), 3 * rng.uniform(-1, 1))
        places.append([size, 0, 0, 0, 0, size, 0, 0, 0, 0, size, 0, x, y, z, 1])
    scene.copies(shape, shape.write(folder), places)
    return scene.write()


def make_scenes(folder, quick):
    """(name, file) of each; of balls the name is how many triangles a shape has."""
    wanted = [("garden", "0.5"), ("forest", "0.04")] if not quick else [("garden", "0.05"), ("forest", "0.002")]
    for name, scale in wanted:
        subprocess.run([sys.executable, ROOT / "tools/make_scenes.py", name, "-o", folder, "--scale", scale], check=True,
                       stdout=subprocess.DEVNULL)
        yield name, folder / name / "scene.json"
    for splits in SPLITS if not quick else SPLITS[:2]:
        into = folder / f"balls{splits}"
        into.mkdir(parents=True, exist_ok=True)
        yield str(20 * 4 ** splits), make_balls(into, splits)


def prepared(build, scene, choice):
    """Processor seconds and bytes of loading, preparing and rendering one pixel; and how many triangles there are."""
    command = [str(build / "bin/kairos"), "render", str(scene), "-o", str(scene.with_suffix(".exr")), "--integrator", "tc",
               "--tc-rays", str(RAYS), "--shading", "normal", "--size", f"{WIDTH}x{HEIGHT}", "--crop", "0,1,0,1", "--threads", "1",
               "--instances", choice]
    child = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    text = child.stdout.read()
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode != 0:
        sys.exit(f"status {child.returncode} from {' '.join(command)}\n{text}")
    triangles = int(re.search(r"(\d+) triangles", text)[1])
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024, triangles


def ray_costs(build, scene, choice, rounds):
    """Nanoseconds of a time-continuous ray, one for each round."""
    out = scene.with_suffix(".csv")
    command = [build / "bin/bench_renders", scene, "--size", f"{WIDTH}x{HEIGHT}", "--tc-rays", str(RAYS), "--keys", "0", "--bands", "3",
               "--rounds", str(rounds), "--thread-rounds", "0", "--build-rounds", "0", "--instances", choice, "--csv", out]
    subprocess.run([str(word) for word in command], check=True, stderr=subprocess.DEVNULL)
    return [float(row["value"]) for row in read_rows(out) if row["measure"] == "tc_ns"]


def measure(build, out, quick):
    rows = []
    for name, scene in make_scenes(out / "scenes", quick):
        for choice in ("never", "always"):
            def add(what, round_, value):
                rows.append({"scene": name, "instances": choice, "measure": what, "round": round_, "value": f"{value:.5g}"})  # noqa: B023
            for round_ in range(1 if quick else 3):
                seconds, held, triangles = prepared(build, scene, choice)
                add("prepare_s", round_, seconds)
                add("bytes", round_, held)
                add("triangles", round_, triangles)
            for round_, cost in enumerate(ray_costs(build, scene, choice, 1 if quick else 3)):
                add("ray_ns", round_, cost)
        print("; ".join(f"{row['instances']} {row['measure']} {row['value']}" for row in rows if row["scene"] == name), file=sys.stderr)
    write_rows(out / "instances.csv", rows)
    return rows


def power_of_two(value):
    """The nearest."""
    return 1 << max(0, round(math.log2(value)))


def fit(rows):
    """Names of constants and their values."""
    values = {}
    for row in rows:
        values.setdefault((row["scene"], row["instances"], row["measure"]), []).append(float(row["value"]))
    scenes = list(dict.fromkeys(row["scene"] for row in rows))

    def cost(scene, choice, what):
        return statistics.median(values[scene, choice, what])

    per_pixel, bytes_each, saved = [], [], []
    for scene in scenes:
        triangles = cost(scene, "never", "triangles")
        copied, shared = cost(scene, "never", "prepare_s"), cost(scene, "always", "prepare_s")
        dearer = cost(scene, "always", "ray_ns") - cost(scene, "never", "ray_ns")
        # For so many triangles in a pixel the rays of the picture cost as much more as preparing copies does.
        if dearer > 0:
            per_pixel.append(RAYS * dearer * 1e-9 / ((copied - shared) / triangles))
        bytes_each.append(cost(scene, "never", "bytes") / triangles)
        if scene.isdigit():
            saved.append((math.log2(int(scene)), (copied - shared) / copied))
    saved.sort()
    least = saved[-1][0]
    for (small, below), (large, above) in zip(saved, saved[1:]):
        if below < LEAST_SAVED <= above:
            least = small + (large - small) * (LEAST_SAVED - below) / (above - below)
    if saved[0][1] >= LEAST_SAVED:
        least = saved[0][0]
    return {"kLeastTriangles": 1 << math.ceil(least), "kCopiedPerPixel": power_of_two(statistics.geometric_mean(per_pixel)),
            "kMostCopied": power_of_two(MOST_BYTES / statistics.median(bytes_each))}


def committed():
    """The same as they are in the source."""
    text = (ROOT / "src/scene/instancing.cpp").read_text()
    found = {name: re.search(rf"{name} = (.*);", text)[1] for name in ("kLeastTriangles", "kCopiedPerPixel", "kMostCopied")}
    return {name: eval(value.replace("uint64_t{1}", "1"), {}) for name, value in found.items()}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path, nargs="?", metavar="BUILD")
    parser.add_argument("out", type=pathlib.Path, nargs="?", metavar="OUT")
    parser.add_argument("--quick", action="store_true", help="only to see whether everything runs")
    parser.add_argument("--fit", type=pathlib.Path, metavar="FILE.csv")
    options = parser.parse_args()
    if not options.fit and not (options.build and options.out):
        parser.error("give BUILD and OUT, or --fit FILE.csv")
    rows = read_rows(options.fit) if options.fit else measure(options.build, options.out, options.quick)
    was = committed()
    for name, value in fit(rows).items():
        print(f"{name} = {value}; {'as' if was[name] == value else was[name]} in src/scene/instancing.cpp")


if __name__ == "__main__":
    main()
