"""What pictures over time take, and how exact they are: the table of docs/time.md, "What it takes".

Usage: bench/exposures.py BUILD_DIR SCENES_FOLDER [WIDTHxHEIGHT [RAYS]]

SCENES_FOLDER holds what tools/make_scenes.py made, a folder for each scene; those that are not there are left out.
"""

import json
import math
import pathlib
import subprocess
import sys
import tempfile

if len(sys.argv) < 3 or "--help" in sys.argv:
    sys.exit(__doc__)
build, scenes = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
size = sys.argv[3] if len(sys.argv) > 3 else "240x135"
rays = sys.argv[4] if len(sys.argv) > 4 else "16"
pixels = math.prod(map(int, size.split("x")))
STACK = 64
SHOTS = (("kitchen, moving camera", "kitchen/scene.pbrt", ()), ("kitchen, everything fast", "kitchen/fast.pbrt", ()),
         ("hall", "hall/scene.json", ("--frame", "6")), ("foliage", "foliage/scene.json", ()), ("blades", "blades/scene.json", ()),
         ("wires", "wires/scene.json", ()))


def run(*command):
    return subprocess.run([str(word) for word in command], check=True, stdout=subprocess.PIPE, text=True).stdout


def bytes_of(*paths):
    return f"{sum(path.stat().st_size for path in paths) / pixels:.0f}"


print(f"| scene | with the file / without | coded, bytes | exact | stack of {STACK} | deep EXR of pieces | coded: largest error, RMS "
      "| stack | first exposure, ms | later |")
print("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |")
for title, name, options in SHOTS:
    if not (scenes / name).exists():
        print(f"{name} is not there", file=sys.stderr)
        continue
    with tempfile.TemporaryDirectory() as text:
        folder = pathlib.Path(text)
        coded, exact, deep = folder / "coded.ktime", folder / "exact.ktime", folder / "deep.exr"

        def render(*more):
            run(build / "bin/kairos", "render", scenes / name, *options, "--size", size, "--integrator", "tc", "--tc-rays", rays, "--shading",
                "normal", "--threads", 1, "--quiet", "--stats-file", folder / "stats.json", "-o", folder / "beside.exr", *more)
            return json.loads((folder / "stats.json").read_text())["render_cpu_seconds"]

        without = min(render() for _ in range(2))
        with_file = min(render("--time", coded) for _ in range(2))
        render("--time", exact, "--time-tolerance", "exact")
        run(build / "bin/kairos", "convert", exact, "-o", deep, "--quiet")
        run(build / "bin/kairos", "expose", exact, "-o", folder / "stack_%d.exr", "--stack", STACK, "--half", "--quiet")
        errors = run(build / "bin/bench_exposures", exact, coded, "--stack", STACK).strip()
        print(f"| {title} | {with_file / without:.2f} | {bytes_of(coded)} | {bytes_of(exact)} | {bytes_of(*folder.glob('stack_*.exr'))} "
              f"| {bytes_of(deep)} | {errors} |", flush=True)
