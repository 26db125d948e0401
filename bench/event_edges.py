"""Stamps of events of a straight edge against closed form, of Kairos and of chains of frames: a table of docs/events.md.

Usage: bench/event_edges.py BUILD_DIR [PIXELS_PER_SECOND]

An oblique edge between light of 0.1 and 1 flies over 160x60 pixels. Coverage is that of docs/events.md, "Edges".
"""

import json
import math
import pathlib
import subprocess
import sys
import tempfile

if len(sys.argv) < 2 or "--help" in sys.argv:
    sys.exit(__doc__)
build, speed = pathlib.Path(sys.argv[1]), float(sys.argv[2]) if len(sys.argv) > 2 else 1000
kairos, frames = build / "bin/kairos", build / "bin/bench_event_frames"
WIDTH, HEIGHT, ANGLE, BEFORE, AFTER, DARK, THRESHOLD = 160, 60, math.radians(20), 0.1, 1.0, 1 / 255, 0.2
COS, SIN = math.cos(ANGLE), math.sin(ANGLE)
FIRST = -100  # where the edge is at time 0, in pixels from the film's middle along its normal
LENGTH = 200 / speed  # seconds


def run(*command):
    return subprocess.run([str(word) for word in command], check=True, stdout=subprocess.PIPE, text=True).stdout


def way(covered):
    """How far the edge is past a pixel's middle when so much of it is covered: 0 to 1."""
    large, small = max(COS, SIN), min(COS, SIN)
    half = (large + small) / 2
    if covered <= small / (2 * large):
        return -half + math.sqrt(2 * large * small * covered)
    if covered <= 1 - small / (2 * large):
        return large * (covered - 0.5)
    return half - math.sqrt(2 * large * small * (1 - covered))


def write_scene(folder):
    """The half-plane as a quad at z = -1, before a camera that sees HEIGHT pixels of 1 / HEIGHT there."""
    pixel, text = 1 / HEIGHT, ""
    for back, side in ((0, -400), (0, 400), (900, 400), (900, -400)):
        right, down = -back * COS - side * SIN, -back * SIN + side * COS
        text += f"v {right * pixel} {-down * pixel} -1\n"
    (folder / "plane.obj").write_text(text + "f 1 2 3\nf 1 3 4\n")

    def shift(time):
        far = FIRST + speed * time
        return {"time": time, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, far * COS * pixel, -far * SIN * pixel, 0, 1]}

    scene = {"kairos": 1, "meshes": [{"name": "plane", "keys": ["plane.obj"], "material": "bright", "transform": [shift(-1), shift(LENGTH + 1)]}],
             "materials": {"bright": {"base_color": [AFTER] * 3}}, "background": [BEFORE] * 3,
             "camera": {"vfov_degrees": 2 * math.degrees(math.atan(0.5)), "keys": [{"time": 0, "eye": [0, 0, 0], "target": [0, 0, -1], "up": [0, 1, 0]}]}}
    (folder / "scene.json").write_text(json.dumps(scene))
    return folder / "scene.json"


def write_truth(path):
    events = []
    levels = [BEFORE + DARK]
    while levels[-1] * math.exp(THRESHOLD) < AFTER + DARK:
        levels.append(levels[-1] * math.exp(THRESHOLD))
    ways = [way((level - BEFORE - DARK) / (AFTER - BEFORE)) for level in levels[1:]]
    for y in range(HEIGHT):
        for x in range(WIDTH):
            middle = (x + 0.5 - WIDTH / 2) * COS + (y + 0.5 - HEIGHT / 2) * SIN
            events += [(round((middle + past - FIRST) / speed * 1e9), y, x) for past in ways]
    lines = [f"{time} {x} {y} 1" for time, y, x in sorted(events) if 0 <= time < LENGTH * 1e9]
    path.write_text("# time [ns], x, y, polarity\n" + "\n".join(lines) + "\n")


with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    scene, truth, out = write_scene(folder), folder / "truth.txt", folder / "out.npz"
    write_truth(truth)
    print(f"{speed:g} pixels a second\n")
    print("| method | processor s | median, us | 95 of 100 below, us | worst, us | missing | too many | in the 20 busiest us |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")

    def row(method, seconds):
        found = json.loads(run(kairos, "events", "compare", truth, out, "--json"))
        part = 100 / found["reference_events"]
        print(f"| {method} | {seconds:.2f} | {found['median_us']:.3g} | {found['p95_us']:.3g} | {found['most_us']:.3g} "
              f"| {found['missing'] * part:.1f} % | {found['extra'] * part:.1f} % | {100 * found['pillars']:.1f} % |", flush=True)

    for edges in ("area", "step"):
        for rays in (1, 4, 16):
            run(kairos, "events", scene, "-o", out, "--time-unit", "ns", "--shading", "flat", "--size", f"{WIDTH}x{HEIGHT}", "--from", 0, "--to", LENGTH,
                "--rays", rays, "--edges", edges, "--threads", 1, "--quiet")
            row(f"kairos, {edges}, {rays} rays", json.loads(pathlib.Path(f"{out}.json").read_text())["cpu_s"])
    for rule in ("esim", "v2e"):
        for fps, samples in ((500, 16), (1000, 4), (1000, 16), (2000, 16), (5000, 16)):
            row(f"frames, {rule}'s rule, {fps} a second, {samples} samples",
                float(run(frames, scene, "-o", out, "--width", WIDTH, "--height", HEIGHT, "--from", 0, "--to", LENGTH, "--fps", fps, "--samples", samples,
                          "--rule", rule).split()[0]))
