"""Stamps of events against a converged reference, and against chains of frames in equal processor time: the tables of
docs/events.md.

Usage: bench/events.py BUILD_DIR DEMO.glb [SCENE...]

SCENE: demo, fast, slow, shadow, foliage, lit, still, texture; all where none is named. Scenes are made by tools/make_scenes.py, and
here, and squeezed into as many seconds as the table says.
"""

import json
import math
import pathlib
import random
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
if len(sys.argv) < 3 or "--help" in sys.argv:
    sys.exit(__doc__)
build, demo = pathlib.Path(sys.argv[1]), sys.argv[2]
kairos, frames = build / "bin/kairos", build / "bin/bench_event_frames"
WIDTH, HEIGHT = 80, 60
EXACT_KEYS = "0.0005"  # pixels: motion between keys is not what is compared


def run(*command):
    return subprocess.run([str(word) for word in command], check=True, stdout=subprocess.PIPE, text=True).stdout


def made(folder, name, seconds, *options):
    """A scene of tools/make_scenes.py whose shutter, and all that moves in it, takes `seconds`."""
    if not (folder / name).exists():
        run(sys.executable, ROOT / "tools/make_scenes.py", name, "-o", folder, *options)
    scene = json.loads((folder / name / "scene.json").read_text())
    for mesh in scene["meshes"]:
        count = len(mesh["keys"])
        if count > 1:
            mesh["times"] = [time * seconds for time in mesh.get("times", [k / (count - 1) for k in range(count)])]
    scene["shutter"] = [0, seconds]
    path = folder / name / f"in_{seconds}.json"
    path.write_text(json.dumps(scene))
    return path


def moving(x, y, seconds):
    """A transform that goes from (0, 0) to (x, y)."""
    return [{"time": time, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x * time / seconds, y * time / seconds, 0, 1]} for time in (-1, seconds + 1)]


def still(folder, seconds):
    """A hall at rest, and one small thing that moves in it."""
    path = made(folder, "still", seconds)
    scene = json.loads(path.read_text())
    eye, target = (scene["camera"]["keys"][0][name] for name in ("eye", "target"))
    way = [b - a for a, b in zip(eye, target)]
    x, y, z = (a + b * 2 / math.hypot(*way) for a, b in zip(eye, way))
    (path.parent / "mover.obj").write_text(f"v {x - .1} {y - .1} {z}\nv {x + .1} {y - .1} {z}\nv {x} {y + .1} {z}\nf 1 2 3\n")
    scene["materials"]["mover"] = {"base_color": [0.9, 0.1, 0.1]}
    scene["meshes"].append({"name": "mover", "keys": ["mover.obj"], "material": "mover", "transform": moving(0.3, 0.1, seconds)})
    path.write_text(json.dumps(scene))
    return path


def texture(folder, seconds):
    """A plane with a picture of noise, two texels for each pixel, that goes 20 pixels."""
    side, pixel, shades = 512, 1 / HEIGHT, random.Random(1)
    head = bytes([0, 0, 3, 0, 0, 0, 0, 0, 0, 0, 0, 0, side & 255, side >> 8, side & 255, side >> 8, 8, 0])  # TGA, grey
    (folder / "noise.tga").write_bytes(head + bytes(shades.randrange(256) for _ in range(side * side)))
    half = side / 4 * pixel
    corners = "".join(f"v {x * half} {y * half} -1\nvt {(x + 1) / 2} {(y + 1) / 2}\n" for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1)))
    (folder / "plane.mtl").write_text("newmtl noise\nKd 1 1 1\nmap_Kd noise.tga\n")
    (folder / "plane.obj").write_text(f"mtllib plane.mtl\nusemtl noise\n{corners}f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n")
    scene = {"kairos": 1, "meshes": [{"name": "plane", "keys": ["plane.obj"], "transform": moving(18 * pixel, 9 * pixel, seconds)}],
             "camera": {"vfov_degrees": 2 * math.degrees(math.atan(0.5)), "keys": [{"eye": [0, 0, 0], "target": [0, 0, -1]}]}, "shutter": [0, seconds]}
    (folder / "texture.json").write_text(json.dumps(scene))
    return folder / "texture.json"


def compare(scene, shading, start, end, most_rays):
    out, reference = scene_folder / "out.npz", scene_folder / "reference.npz"

    def record(path, rays, edges, tolerance=EXACT_KEYS):
        run(kairos, "events", scene, "-o", path, "--time-unit", "ns", "--shading", shading, "--size", f"{WIDTH}x{HEIGHT}", "--from", start, "--to", end, "--rays", rays,
            "--edges", edges, "--motion-tolerance", tolerance, "--threads", 1, "--quiet")
        return json.loads(pathlib.Path(f"{path}.json").read_text())["cpu_s"]

    def chain(rule, samples, *rate):
        """Processor seconds, and the number of frames."""
        words = run(frames, scene, "-o", out, "--width", WIDTH, "--height", HEIGHT, "--from", start, "--to", end, "--shading", shading, "--samples", samples, "--rule", rule,
                    *rate).split()
        return float(words[0]), int(words[1])

    def row(name, seconds):
        difference = json.loads(run(kairos, "events", "compare", reference, out, "--json"))
        apart = 100 / max(difference["reference_events"], 1)
        print(f"| {name} | {seconds:.2g} | {difference['median_us']:.3g} | {difference['p95_us']:.3g} "
              f"| {difference['missing'] * apart:.1f} % | {difference['extra'] * apart:.1f} % | {100 * difference['pillars']:.1f} % |", flush=True)

    length = end - start
    record(reference, most_rays, "area")
    print("| method | processor s | median, us | 95 of 100 below, us | missing | too many | in the 20 busiest us |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    row("kairos, area, 1 ray", record(out, 1, "area"))
    row("kairos, step, 4 rays", record(out, 4, "step"))
    row("kairos, area, 16 rays", record(out, 16, "area"))
    budget = record(out, 4, "area")
    row("kairos, area, 4 rays", budget)
    for rule, samples in (("esim", 4), ("esim", 16), ("v2e", 4), ("v2e", 16)):
        few = 10
        price = chain(rule, samples, "--fps", few / length)[0] / (few + 1)
        rate = min(max(budget / price / length, 20), 50000)
        seconds, count = chain(rule, samples, "--fps", rate)
        row(f"frames, {rule}'s rule, {samples} samples, {count / length:.0f} a second: equal time", seconds)
    seconds, count = chain("esim", 4, "--adaptive", 0.5)
    row(f"frames, esim's rule, 4 samples, {count / length:.0f} a second: its own choice", seconds)


with tempfile.TemporaryDirectory() as name:
    scene_folder = pathlib.Path(name)
    scenes = {
        "demo": ("a tenth of a second of the demo scene", lambda: demo, "flat", 0.5, 0.6, 64),
        "fast": ("pebbles that fly 17 pixels in 0.02 s", lambda: made(scene_folder, "swarm", 0.02, "--motion", 200), "flat", 0, 0.02, 64),
        "slow": ("the same in a second", lambda: made(scene_folder, "swarm", 1, "--motion", 200), "flat", 0, 1, 64),
        "shadow": ("the shadow of a fan on a floor at rest, in 0.1 s, lit", lambda: made(scene_folder, "shade", 0.1), "whitted", 0, 0.1, 64),
        "foliage": ("trees in a storm, in 0.1 s", lambda: made(scene_folder, "foliage", 0.1, "--scale", 0.1), "flat", 0, 0.1, 64),
        "lit": ("the same, lit", lambda: made(scene_folder, "foliage", 0.1, "--scale", 0.1), "whitted", 0, 0.1, 64),
        "still": ("a hall at rest, in which one small thing moves for half a second, lit", lambda: still(scene_folder, 0.5), "whitted", 0, 0.5, 64),
        "texture": ("noise of half a pixel that goes 20 pixels in 0.1 s", lambda: texture(scene_folder, 0.1), "flat", 0, 0.1, 64),
    }
    for chosen in sys.argv[3:] or scenes:
        title, make, shading, start, end, most_rays = scenes[chosen]
        print(f"\n**{chosen}**: {title}; reference of {most_rays} rays\n", flush=True)
        compare(make(), shading, start, end, most_rays)
