#!/usr/bin/env python3
"""How much the noise of light flickers over the frames of a sequence, with light that pixels share and without, in equal time.

    bench/flicker.py FOLDER [--scene NAME|FILE] [--kairos build/release/bin/kairos] [--size 640x360] [--frames 0-47] [--samples 4,8,16,32,64]
                     [--shared 16,32] [--reference 512]

FOLDER: where scenes are, or are made, and pictures go. Renders the frames by discrete samples without cells (--samples, a number of them for each row), and by
discrete samples and `auto` with cells (--shared). Prints a table in Markdown: processor time a frame on one thread without loading and building, decibels against
--reference discrete samples of another seed without cells, and the flicker of `kairos compare --frames`, which is how much the error changes from frame to frame.
Beside that of pictures with cells stands the flicker of discrete samples in the same time, on straight lines of logarithms.

Needs Python's standard library alone.
"""
import argparse
import json
import math
import os
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent


class Sequences:
    def __init__(self, args):
        self.args = args
        self.folder = pathlib.Path(args.folder)
        self.scene = pathlib.Path(args.scene) if "." in args.scene else self.folder / args.scene / "scene.json"
        if not self.scene.exists() and "." not in args.scene:
            subprocess.run([sys.executable, ROOT / "tools/make_scenes.py", args.scene, "-o", self.folder], check=True, stdout=subprocess.DEVNULL)

    def render(self, name, *options):
        """The pictures' name, and seconds of a frame."""
        first, last = map(int, self.args.frames.split("-"))
        out, stats = self.folder / f"{name}_%04d.exr", self.folder / f"{name}_%04d.json"
        for frame in range(first, last + 1):  # else those of earlier runs would stay
            (self.folder / f"{name}_{frame:04d}.exr").unlink(missing_ok=True)
        subprocess.run([self.args.kairos, "render", self.scene, "-o", out, "--frames", self.args.frames, "--shading", "whitted", "--size", self.args.size,
                        "--threads", "1", "--quiet", "--stats-file", stats, *map(str, options)], check=True)
        frames = [json.loads(pathlib.Path(str(stats) % frame).read_text()) for frame in range(first, last + 1)]
        return out, sum(one["render_cpu_seconds"] for one in frames) / len(frames)

    def compare(self, reference, out):
        """Decibels and flicker."""
        text = subprocess.run([self.args.kairos, "compare", reference, out, "--frames", self.args.frames], check=True, text=True, stdout=subprocess.PIPE).stdout
        return tuple(float(re.search(pattern, text)[1]) for pattern in (r"PSNR\s+([\d.]+)", r"flicker\s+([\d.e+-]+)"))


def flicker_at(rows, seconds):
    """Of rows by time, (seconds, flicker)."""
    (t0, f0), (t1, f1) = next(((a, b) for a, b in zip(rows, rows[1:]) if seconds <= b[0]), rows[-2:])
    return f0 * (f1 / f0) ** (math.log(seconds / t0) / math.log(t1 / t0))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder")
    parser.add_argument("--scene", default="hall")
    parser.add_argument("--kairos", default=str(ROOT / "build/release/bin/kairos"))
    parser.add_argument("--size", default="640x360")
    parser.add_argument("--frames", default="0-47")
    parser.add_argument("--samples", default="4,8,16,32,64", type=lambda text: [int(n) for n in text.split(",")])
    parser.add_argument("--shared", default="16,32", type=lambda text: [int(n) for n in text.split(",")])
    parser.add_argument("--reference", type=int, default=512)
    args = parser.parse_args()
    if len(args.samples) < 2:
        parser.error("it takes two numbers of samples to tell what flickers in the time of a third")
    os.makedirs(args.folder, exist_ok=True)
    sequences = Sequences(args)
    reference, _ = sequences.render("reference", "--integrator", "qmc", "--spp", args.reference, "--seed", 1001)
    commit = subprocess.run(["git", "-C", ROOT, "rev-parse", "--short", "HEAD"], capture_output=True, text=True).stdout.strip()
    print(f"{sequences.scene.parent.name if sequences.scene.stem == 'scene' else sequences.scene.name}, frames {args.frames}, {args.size}, one seed, against {args.reference} discrete samples, commit {commit}\n")
    print("| samples | seconds a frame | error | flicker | of discrete samples in that time |\n| --- | --- | --- | --- | --- |", flush=True)
    rows = []
    for spp in args.samples:
        out, seconds = sequences.render("discrete", "--integrator", "qmc", "--cells", "off", "--spp", spp)
        level, flicker = sequences.compare(reference, out)
        rows.append((seconds, flicker))
        print(f"| {spp} discrete | {seconds:.2f} | {level:.1f} dB | {flicker:.5f} | |", flush=True)
    for spp in args.shared:
        for integrator, cells in (("qmc", "on"), ("auto", "auto")):
            out, seconds = sequences.render("shared", "--integrator", integrator, "--cells", cells, "--spp", spp)
            level, flicker = sequences.compare(reference, out)
            name = {"qmc": "discrete", "auto": "`auto`"}[integrator]
            print(f"| {spp} {name}, cells | {seconds:.2f} | {level:.1f} dB | {flicker:.5f} | {flicker_at(rows, seconds):.5f} |", flush=True)


if __name__ == "__main__":
    main()
