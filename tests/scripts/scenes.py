"""The benchmark scenes: the same bytes on every run, something that moves, and one picture from both kinds of rays.

Usage: scenes.py PROJECT_ROOT KAIROS FOLDER NAME...

Scenes made of third parties' files are left out where $KAIROS_SCENES has none.
"""

import json
import os
import pathlib
import re
import subprocess
import sys

root, kairos, out, names = pathlib.Path(sys.argv[1]), sys.argv[2], pathlib.Path(sys.argv[3]), sys.argv[4:]
third_parties = pathlib.Path(os.environ.get("KAIROS_SCENES", "no scenes")).resolve()
NEEDS = {"hall": ["mannequiny"], "fan": ["vintage-fan"], "kitchen": ["bitterli-kitchen"],
         "big": ["bitterli-kitchen", "dutch-ship"]}
# PSNR of 64 time-continuous rays against 256 discrete samples: what noise leaves, and no more.
AGREE, SIZE = 36.0, "64x36"
# The work of these rays, the same for all instruction sets: a change that costs work is seen here without a clock. Where one is meant to alter it,
# take over what is printed, and say in the commit what became of the work.
COUNTED = ("nodes", "triangles_tested", "root_solves", "hits", "segments")
WORK = {
    "crowd": (13834, 146992, 630729, 222995, 173496),
    "garden": (54196, 322696, 1969080, 294259, 275367),
    "forest": (2033109, 9718699, 17971101, 1434502, 944387),
    "veils": (9216, 28884, 74886, 88384, 88384),
    "hair": (105068, 1134466, 11157405, 2566993, 1982335),
}


def run(*command, **options):
    done = subprocess.run([str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          **options)
    if done.returncode != 0:
        sys.exit(f"status {done.returncode} from {' '.join(map(str, command))}\n{done.stdout}")
    return done.stdout


def make(name, folder, hash_seed):
    environment = {**os.environ, "PYTHONHASHSEED": hash_seed, "PYTHONDONTWRITEBYTECODE": "1"}
    run(sys.executable, root / "tools/make_scenes.py", name, "-o", folder, "--scale", "0.02", "--scenes", third_parties,
        env=environment)
    return {path.relative_to(folder): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


failures = []
for name in names:
    absent = [part for part in NEEDS.get(name, []) if not (third_parties / part).is_dir()]
    if absent:
        print(f"{name}: skipped; no folder {third_parties / absent[0]}, set KAIROS_SCENES")
        continue
    if make(name, out / "a", "1") != make(name, out / "b", "2"):
        sys.exit(f"{name}: two runs gave different files")
    scene = next((out / "a" / name).glob("scene.*"))
    info = json.loads(run(kairos, "info", scene, "--json"))
    moving = [mesh for mesh in info["meshes"] if len(mesh["key_times"]) > 1]
    if bool(moving) == (name == "still"):
        sys.exit(f"{name}: {len(moving)} of {len(info['meshes'])} meshes move")
    shot = [scene, "--size", SIZE, "--shading", "normal", "--quiet"]
    run(kairos, "render", *shot, "-o", out / "tc.exr", "--integrator", "tc", "--tc-rays", "64", "--stats-file", out / "stats.json")
    counters = json.loads((out / "stats.json").read_text())["counters"]
    work = tuple(counters[what] for what in COUNTED)
    if name in WORK and work != WORK[name]:
        failures.append(f'    "{name}": {work},')
    run(kairos, "render", *shot, "-o", out / "qmc.exr", "--integrator", "qmc", "--spp", "256")
    psnr = float(re.search(r"PSNR ([\d.]+)", run(kairos, "compare", out / "qmc.exr", out / "tc.exr"))[1])
    print(f"{name}: {info['triangles']} triangles, {len(moving)} meshes move, {psnr:.1f} dB")
    if psnr < AGREE:
        sys.exit(f"{name}: time-continuous and discrete rays are {psnr} dB from each other")
if failures:
    sys.exit("other work than known:\n" + "\n".join(failures))
