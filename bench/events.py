"""Stamps of events against a converged reference, and against chains of frames: the table of docs/events.md.

Usage: bench/events.py BUILD_DIR SCENE.glb [FROM TO [WIDTH HEIGHT]]
"""

import json
import pathlib
import subprocess
import sys
import tempfile

build, scene = pathlib.Path(sys.argv[1]), sys.argv[2]
start, end = sys.argv[3:5] if len(sys.argv) > 4 else ("0.5", "0.75")
width, height = sys.argv[5:7] if len(sys.argv) > 6 else ("120", "90")
kairos, frames = build / "bin/kairos", build / "bin/bench_event_frames"
EXACT_KEYS = "0.0005"  # pixels: motion between keys is not what is compared


def run(*command):
    return subprocess.run([str(word) for word in command], check=True, stdout=subprocess.PIPE, text=True).stdout


with tempfile.TemporaryDirectory() as folder:
    reference, out = f"{folder}/reference.npz", f"{folder}/out.npz"

    def record(path, rays, edges, tolerance=EXACT_KEYS):
        run(kairos, "events", scene, "-o", path, "--time-unit", "ns", "--shading", "flat", "--size", f"{width}x{height}", "--from", start,
            "--to", end, "--rays", rays, "--edges", edges, "--motion-tolerance", tolerance, "--threads", 1, "--quiet")
        return json.loads(pathlib.Path(path + ".json").read_text())["cpu_s"]

    def row(name, seconds):
        difference = json.loads(run(kairos, "events", "compare", reference, out, "--json"))
        apart = 100 / difference["reference_events"]
        print(f"| {name} | {seconds:.1f} | {difference['median_us']:.3g} | {difference['p95_us']:.3g} "
              f"| {difference['missing'] * apart:.1f} % | {difference['extra'] * apart:.1f} % | {100 * difference['pillars']:.1f} % |", flush=True)

    record(reference, 256, "area")
    print("| method | processor s | median, us | 95 of 100 below, us | missing | too many | in the 20 busiest us |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for edges in ("area", "step"):
        for rays in (1, 4, 16):
            row(f"kairos, {edges}, {rays} rays", record(out, rays, edges))
    row("kairos, area, 4 rays, keys to 0.005 px", record(out, 4, "area", "0.005"))
    for rule in ("esim", "v2e"):
        for fps, samples in ((500, 16), (1000, 4), (2000, 4)):
            row(f"frames, {rule}'s rule, {fps} a second, {samples} samples",
                float(run(frames, scene, "-o", out, "--width", width, "--height", height, "--from", start, "--to", end, "--fps", fps, "--samples", samples,
                          "--rule", rule)))
