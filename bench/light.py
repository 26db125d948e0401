#!/usr/bin/env python3
"""Lit pictures: the error of time-continuous rays, mixed and auto beside discrete samples in the same time, scene by scene.

    bench/light.py FOLDER [--kairos build/release/bin/kairos] [--scenes NAME,...] [--size 320x180] [--budgets 16,64] [--seeds 3]
                   [--reference 1024] [--shading whitted] [--csv FILE]
    bench/light.py FOLDER --scan
    bench/light.py FOLDER --shadow-prices [--scenes shade]
    bench/light.py FOLDER --ground
    bench/light.py FOLDER --film [--scenes kitchen,...] [--seeds 2] [--reference 256]

FOLDER: where scenes are, or are made, and pictures go. Prints a table in Markdown: decibels against discrete samples (two pictures of --reference samples, whose own
noise is taken off; values above 1 count as 1), in seconds of processor time of one thread without loading and building, and the gain over discrete
samples on straight lines of decibels over the logarithm of time; medians over seeds. Below, which method loses where. --csv: the same as numbers, for bench/run.py. With --scan it looks instead for pixels that are
negative or no number in pictures of few samples of all scenes by all integrators, and ends with status 1 where it finds one. With --shadow-prices it
measures what exact and sampled shadows cost, in nanoseconds, for the constants of src/policy/ray_prices.h and shadow_race.cpp. With --ground it compares what
the sun brings to the ground under the blades, discrete and exact in time, where the ground alone is seen. With --film it runs bench_cells, which lies beside
kairos, on bands of pictures of film size: what light that pixels share is worth there, over discrete samples without it and with it.

Needs Python's standard library alone.
"""
import argparse
import array
import csv
import json
import math
import os
import pathlib
import statistics
import struct
import subprocess
import sys
import zlib

ROOT = pathlib.Path(__file__).resolve().parent.parent
SCENES = {"glass": "glass/scene.json", "marbles": "marbles/scene.json", "hall": "hall/scene.json", "still": "still/scene.json", "fan": "fan/scene.json",
          "shade": "shade/scene.json", "mirrors": "mirrors/scene.json", "foliage": "foliage/scene.json", "blades": "blades/scene.json", "kitchen": "kitchen/scene.pbrt"}
# Of film size: file, size, and a band across it of whole squares of 64 pixels.
FILM = {"kitchen": ("kitchen/scene.pbrt", "960x540", "0,960,256,320"), "fast kitchen": ("kitchen/fast.pbrt", "960x540", "0,960,256,320"),
        "terrain": ("terrain/scene.json", "960x540", "0,960,256,320"), "swarm": ("swarm/scene.json", "960x540", "0,960,256,320"),
        "foliage": ("foliage/scene.json", "640x360", "0,640,128,192"), "hall": ("hall/scene.json", "640x360", "0,640,192,256")}
OPTIONS = {"hall": ["--frame", "6"]}


def read_exr(path):
    """Red, green and blue of each pixel, one after the other: what Kairos writes with --half off, ZIP or not compressed."""
    data = pathlib.Path(path).read_bytes()
    at, channels, window, compression = 8, [], None, 0
    while data[at]:
        name, kind = (data[at:].split(b"\0", 2)[i].decode() for i in range(2))
        at += len(name) + len(kind) + 2
        (size,) = struct.unpack_from("<i", data, at)
        value = data[at + 4:at + 4 + size]
        at += 4 + size
        if name == "channels":
            while value[0] if value else 0:
                channel, value = value.split(b"\0", 1)
                channels.append((channel.decode(), struct.unpack_from("<i", value)[0]))
                value = value[16:]
        elif name == "dataWindow":
            window = struct.unpack("<4i", value)
        elif name == "compression":
            compression = value[0]
    width, height = window[2] - window[0] + 1, window[3] - window[1] + 1
    lines = {0: 1, 2: 1, 3: 16}[compression]
    chunks = -(-height // lines)
    offsets = struct.unpack_from(f"<{chunks}Q", data, at + 1)
    planes = {name: array.array("f") for name in "RGB"}
    for chunk, offset in enumerate(offsets):
        (size,) = struct.unpack_from("<i", data, offset + 4)
        rows = min(lines, height - chunk * lines)
        raw = data[offset + 8:offset + 8 + size]
        if size < rows * width * sum(2 if kind == 1 else 4 for _, kind in channels):
            raw = bytearray(zlib.decompress(raw))
            for i in range(1, len(raw)):
                raw[i] = (raw[i - 1] + raw[i] - 128) & 255
            half = (len(raw) + 1) // 2
            woven = bytearray(len(raw))
            woven[0::2], woven[1::2] = raw[:half], raw[half:]
            raw = bytes(woven)
        place = 0
        for _ in range(rows):
            for name, kind in channels:
                if kind != 2 and name in planes:
                    sys.exit(f"{path}: a colour is not kept in 32 bits")
                length = width * (2 if kind == 1 else 4)
                if name in planes:
                    planes[name].frombytes(raw[place:place + length])
                place += length
    return [value for name in "RGB" for value in planes[name]]


class Renderer:
    def __init__(self, args):
        self.args = args

    def scene(self, name):
        folder = pathlib.Path(self.args.folder)
        path = folder / SCENES[name]
        if not path.exists():
            subprocess.run([sys.executable, ROOT / "tools/make_scenes.py", SCENES[name].split("/")[0], "-o", folder], check=True, stdout=subprocess.DEVNULL)
        return path if path.exists() else None

    def render(self, name, *options):
        """The picture, and the seconds of processor time that rendering took."""
        out = os.path.join(self.args.folder, "light.exr")
        stats = self.stats(name, out, *options)
        return read_exr(out), stats["render_cpu_seconds"]

    def stats(self, name, out, *options):
        file = os.path.join(self.args.folder, "light.json")
        subprocess.run([self.args.kairos, "render", str(self.scene(name)), "-o", out, "--shading", self.args.shading, "--size", self.args.size,
                        "--threads", "1", "--quiet", "--stats-file", file, *OPTIONS.get(name, []), *map(str, options)], check=True)
        return json.loads(pathlib.Path(file).read_text())


def commit_name():
    return subprocess.run(["git", "-C", ROOT, "rev-parse", "--short", "HEAD"], capture_output=True, text=True).stdout.strip()


def squared(a, b):
    """The mean squared difference of two pictures."""
    return sum((min(p, 1.0) - min(q, 1.0)) ** 2 for p, q in zip(a, b)) / len(a)


def decibels(error):
    return -10 * math.log10(max(error, 1e-12))


def ground(renderer, args):
    """Of the blades by the sun alone; pixels that see nothing but the ground, which rests, with the whirlwind's shadow."""
    scene = json.loads(renderer.scene("blades").read_text())
    scene["lights"] = [light for light in scene["lights"] if light["type"] == "directional"]
    (renderer.scene("blades").parent / "sun.json").write_text(json.dumps(scene))
    SCENES["sun"] = "blades/sun.json"
    args.size = "320x180"
    crop = ["--crop", "0,130,132,180"]
    pictures = [renderer.render("sun", *crop, "--integrator", "tc", "--tc-rays", args.reference, "--shadows", "exact", "--seed", seed)[0] for seed in (1001, 1002)]
    reference, noise = [(a + b) / 2 for a, b in zip(*pictures)], squared(*pictures) / 4

    def measured(*options):
        runs = [renderer.render("sun", *crop, *options, "--seed", seed) for seed in range(args.seeds)]
        return statistics.median(t for _, t in runs), decibels(statistics.median(squared(picture, reference) for picture, _ in runs) - noise)

    discrete = [measured("--integrator", "qmc", "--spp", n) for n in (4, 16, 64, 256)]
    print("| | error, time | gain |\n| --- | --- | --- |")
    for samples, (time, level) in zip((4, 16, 64, 256), discrete):
        print(f"| {samples} discrete samples | {level:.1f} dB in {time:.3f} s | |")
    for text, options in ([(f"{n} rays of `tc`", ["--integrator", "tc", "--tc-rays", n, "--shading-samples", 1]) for n in (2, 4, 8, 16)]
                          + [(f"`mixed`, {n} rays and {4 * n} samples", ["--integrator", "mixed", "--tc-rays", n, "--spp", 4 * n]) for n in (2, 4, 8, 16)]):
        time, level = measured(*options, "--shadows", "exact")
        print(f"| {text}, exact shadows | {level:.1f} dB in {time:.3f} s | {gain(discrete, time, level):+.1f} dB |", flush=True)


def film(renderer, args):
    commit = commit_name()
    for name in args.scenes:
        file, size, crop = FILM[name]
        SCENES[name] = file
        if not renderer.scene(name):
            print(f"{name}: left out, it is not there\n")
            continue
        print(f"{name}, {size}, --crop {crop}, commit {commit}, ", end="", flush=True)
        subprocess.run([pathlib.Path(args.kairos).parent / "bench_cells", renderer.scene(name), "--size", size, "--crop", crop, *OPTIONS.get(name, []), "--spp", "16,64",
                        "--tc", "4x8,8x8", "--auto", "16,64", "--cells", "off,auto", "--seeds", str(max(2, args.seeds)), "--reference", str(args.reference)], check=True)
        print()


def methods(budget):
    return {"discrete": ["--integrator", "qmc", "--spp", budget], "auto": ["--integrator", "auto", "--spp", budget],
            "mixed": ["--integrator", "mixed", "--tc-rays", max(1, budget // 8), "--spp", budget, "--shading-samples", 4],
            "tc": ["--integrator", "tc", "--tc-rays", max(1, budget // 4), "--shading-samples", 4]}


def gain(points, time, level):
    """Over discrete samples: (time, level) pairs by time."""
    (t0, l0), (t1, l1) = next(((a, b) for a, b in zip(points, points[1:]) if time <= b[0]), points[-2:])
    return level - (l0 + (l1 - l0) * math.log(time / t0) / math.log(t1 / t0))


CSV = "scene size shading method budget db seconds gain seeds reference commit".split()


def row(renderer, name, args):
    first, _ = renderer.render(name, "--integrator", "qmc", "--spp", args.reference, "--seed", 1001)
    second, _ = renderer.render(name, "--integrator", "qmc", "--spp", args.reference, "--seed", 1002)
    reference = [(a + b) / 2 for a, b in zip(first, second)]
    noise = squared(first, second) / 4
    found = {}
    for budget in args.budgets:
        for method, options in methods(budget).items():
            if method == "discrete" or method in args.methods:
                runs = [renderer.render(name, *options, "--seed", seed) for seed in range(args.seeds)]
                level = decibels(statistics.median(squared(picture, reference) for picture, _ in runs) - noise)
                found.setdefault(method, []).append((statistics.median(t for _, t in runs), level))
    cells, losses, rows = [], [], []
    for method, points in found.items():
        texts = []
        for budget, (time, level) in zip(args.budgets, points):
            text = f"{level:.1f} in {time:.2f}"
            lead = gain(found["discrete"], time, level)
            rows.append([name, args.size, args.shading, method, budget, f"{level:.3f}", f"{time:.4f}", f"{lead:.3f}", args.seeds, args.reference, commit_name()])
            if method != "discrete":
                text += f" ({lead:+.1f})"
                if lead < -0.3:
                    losses.append(f"{method} on {name} at {budget}: {lead:+.1f} dB")
            texts.append(text)
        cells.append("; ".join(texts))
    print(f"| {name} | " + " | ".join(cells) + " |", flush=True)
    if args.csv:
        with args.csv.open("a", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows(rows)
    return losses


def scan(renderer, args):
    bad = 0
    for name in args.scenes:
        if not renderer.scene(name):
            print(f"{name}: left out, it is not there")
            continue
        for shading in ("whitted", "path"):
            for method, options in methods(args.budgets[0]).items():
                for shadows in ([], ["--shadows", "exact"]) if method != "discrete" else ([],):
                    args.shading = shading
                    picture, _ = renderer.render(name, *options, *shadows)
                    wrong = [value for value in picture if not (0 <= value < math.inf)]
                    bad += len(wrong)
                    print(f"{name}, {shading}, {method} {' '.join(shadows)}: {len(wrong)} of {len(picture)} values negative or none"
                          + (f", least {min(wrong):.3g}" if wrong else ""), flush=True)
    return bad


def shadow_prices(renderer, args):
    """Of a scene with one light that rests, on what rests: by differences between pictures of 4 time-continuous rays."""
    def median(*options):
        runs = [renderer.stats(args.scenes[0], os.path.join(args.folder, "light.exr"), "--integrator", "tc", "--tc-rays", 4, *options)
                for _ in range(args.seeds)]
        return statistics.median(r["render_cpu_seconds"] * 1e9 / r["rays"] for r in runs), runs[0]

    def of_samples(*options):
        one, three = (median("--shadows", "sampled", "--shading-samples", n, *options)[0] for n in (1, 3))
        return (three - one) / 2

    def tracing(stats):  # as tracing_time() has it
        c = stats["counters"]
        return (20 * c["nodes"] + 15 * c["triangles_tested"] + 90 * c["hits"]) / stats["rays"]

    (sampled, of_sampled), (exact, of_exact) = (median("--shadows", s, "--shading-samples", 1) for s in ("sampled", "exact"))
    lit, dark = of_samples(), of_samples("--lights", "none")
    look = exact - sampled + lit - dark
    print(f"{args.scenes[0]}, {args.size}, ns: a shading sample without its ray to a light {dark:.0f}, such a ray and its light {lit - dark:.0f}; "
          f"an exact look {look:.0f}, of which tracing by counts {tracing(of_exact) - tracing(of_sampled):.0f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder")
    parser.add_argument("--kairos", default=str(ROOT / "build/release/bin/kairos"))
    parser.add_argument("--scenes", type=lambda text: text.split(","))
    parser.add_argument("--methods", default="auto,mixed,tc", type=lambda text: text.split(","))
    parser.add_argument("--size", default="320x180")
    parser.add_argument("--budgets", default="16,64", type=lambda text: [int(n) for n in text.split(",")])
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--reference", type=int, default=1024)
    parser.add_argument("--shading", default="whitted")
    parser.add_argument("--csv", type=pathlib.Path)
    parser.add_argument("--scan", action="store_true")
    parser.add_argument("--shadow-prices", action="store_true")
    parser.add_argument("--ground", action="store_true")
    parser.add_argument("--film", action="store_true")
    args = parser.parse_args()
    args.scenes = args.scenes or list(FILM if args.film else SCENES)
    os.makedirs(args.folder, exist_ok=True)
    renderer = Renderer(args)
    if args.scan:
        return 1 if scan(renderer, args) else 0
    if args.film:
        return film(renderer, args)
    if args.ground:
        return ground(renderer, args)
    if args.shadow_prices:
        args.scenes = args.scenes if len(args.scenes) == 1 else ["shade"]
        return shadow_prices(renderer, args)
    if len(args.budgets) < 2:
        parser.error("it takes two budgets to tell what the time of a third is worth")
    commit = commit_name()
    print(f"{args.size}, budgets {', '.join(map(str, args.budgets))}, {args.seeds} seeds, 2 x {args.reference} discrete samples as reference, "
          f"--shading {args.shading}, commit {commit}. dB in seconds (gain over discrete samples in that time).\n")
    if args.csv:
        args.csv.write_text(",".join(CSV) + "\n")
    shown = ["discrete", *(m for m in ("auto", "mixed", "tc") if m in args.methods)]
    print("| scene | " + " | ".join(shown) + " |\n|" + " --- |" * (len(shown) + 1), flush=True)
    losses = [loss for name in args.scenes if renderer.scene(name) for loss in row(renderer, name, args)]
    print("\nLoses by more than 0.3 dB: " + ("; ".join(losses) or "nothing") + ".")
    return 0


if __name__ == "__main__":
    sys.exit(main())
