#!/usr/bin/env python3
"""Renders the demo scene with the tc and the qmc integrator in equal rendering time and compares both with a reference.

Usage: run_demo.py KAIROS OUT_FOLDER [--size WxH] [--tc-rays N] [--reference-spp N]
"""

import argparse
import hashlib
import json
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
SHOT = ["--camera", "square", "--frame", "24", "--fps", "24", "--shutter", "0,0.5", "--shading", "flat"]
REFERENCE_SEED = "7919"  # any other than that of the pictures
# What the magnified crop shows, in fractions of the picture: x, y, width, height. The windmill's hub and blades.
CROP = (0.735, 0.22, 0.125, 0.125)
MATCHED = 0.04  # rendering times closer than this are equal
ATTEMPTS = 5


def say(text):
    print(f"\n== {text}", flush=True)


def run(command):
    try:
        return subprocess.run([str(part) for part in command], check=True, stdout=subprocess.PIPE, text=True).stdout
    except subprocess.CalledProcessError as error:
        sys.exit(f"run_demo.py: failed with status {error.returncode}: {' '.join(error.cmd)}")


class Demo:
    def __init__(self, arguments):
        self.arguments = arguments
        self.out = pathlib.Path(arguments.out)
        self.scene = self.out / "demo.glb"

    def render(self, name, *options):
        """Returns the statistics."""
        picture, stats = self.out / f"{name}.exr", self.out / f"{name}.json"
        run([self.arguments.kairos, "render", self.scene, "-o", picture, "--stats-file", stats, "--quiet", "--size",
             self.arguments.size, *SHOT, *options])
        return json.loads(stats.read_text())

    def render_qmc(self, spp):
        return self.render("demo_qmc", "--integrator", "qmc", "--spp", str(spp))

    def match_time(self, seconds):
        """Renders with as many discrete samples as the given rendering time allows. Returns (spp, statistics)."""
        earlier, best = self.out / "demo_qmc.json", None
        spp = json.loads(earlier.read_text())["samples"] if earlier.exists() else 32
        for _ in range(ATTEMPTS):
            stats = self.render_qmc(spp)
            ratio = seconds / stats["render_seconds"]
            if best is None or abs(ratio - 1) < abs(best[2] - 1):
                best = (spp, stats, ratio)
            if abs(ratio - 1) <= MATCHED:
                return spp, stats
            wanted = max(1, round(spp * min(ratio, 8)))
            if wanted == spp:
                return spp, stats
            spp = wanted
        spp = best[0]  # timings that jump about: take the closest, and the picture that belongs to it
        return spp, self.render_qmc(spp)

    def reference(self):
        """Renders the reference unless the one there came from the same program, scene and options."""
        picture, key_file = self.out / "demo_reference.exr", self.out / "demo_reference.key"
        options = ["--integrator", "qmc", "--spp", str(self.arguments.reference_spp), "--seed", REFERENCE_SEED]
        program = pathlib.Path(self.arguments.kairos).resolve()
        digest = hashlib.sha256(repr([options, SHOT, self.arguments.size]).encode())
        for path in [program, *sorted((program.parent.parent / "lib").glob("libkairos.so.*.*")), self.scene]:
            digest.update(path.read_bytes())
        if picture.exists() and key_file.exists() and key_file.read_text() == digest.hexdigest():
            print("the reference is still there from an earlier run")
            return
        stats = self.render("demo_reference", *options)
        key_file.write_text(digest.hexdigest())
        print(f"took {stats['render_seconds']:.1f} s")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("kairos")
    parser.add_argument("out")
    parser.add_argument("--size", default="960x540")
    parser.add_argument("--tc-rays", type=int, default=8)
    parser.add_argument("--reference-spp", type=int, default=1024)
    arguments = parser.parse_args()
    demo = Demo(arguments)
    demo.out.mkdir(parents=True, exist_ok=True)
    width, height = map(int, arguments.size.split("x"))

    say("Making the demo scene")
    run([sys.executable, ROOT / "tools/make_demo_scene.py", demo.scene])
    print(demo.scene)

    say(f"Rendering {arguments.size} pixels with {arguments.tc_rays} time-continuous rays each")
    tc = demo.render("demo_tc", "--integrator", "tc", "--tc-rays", str(arguments.tc_rays))
    print(f"took {tc['render_seconds']:.2f} s")

    say("Rendering with discrete samples, as many as take the same time")
    spp, qmc = demo.match_time(tc["render_seconds"])
    print(f"took {qmc['render_seconds']:.2f} s with {spp} samples each")

    say(f"Rendering the reference: {arguments.reference_spp} discrete samples, another seed")
    demo.reference()

    say("Comparing (PSNR of linear values, peak 1, against the reference)")
    pictures = [demo.out / "demo_tc.exr", demo.out / "demo_qmc.exr"]
    crop = [round(fraction * side) for fraction, side in zip(CROP, (width, height, width, height))]
    labels = f"tc {arguments.tc_rays} rays {tc['render_seconds']:.1f} s,qmc {spp} samples {qmc['render_seconds']:.1f} s"
    side_by_side = demo.out / "demo_side_by_side.png"
    compare = [arguments.kairos, "compare", demo.out / "demo_reference.exr"]
    print(run([*compare, *pictures, "--labels", labels, "--zoom", ",".join(map(str, crop)), "--side-by-side",
               side_by_side]), end="")
    for picture in pictures:
        run([*compare, picture, "--side-by-side", picture.with_suffix(".png")])

    say("Done")
    print("integrator  rendering  rays per pixel  picture")
    print(f"tc          {tc['render_seconds']:7.2f} s  {arguments.tc_rays:14d}  {pictures[0].with_suffix('.png')}")
    print(f"qmc         {qmc['render_seconds']:7.2f} s  {spp:14d}  {pictures[1].with_suffix('.png')}")
    print(f"side by side, with a magnified part: {side_by_side}")


if __name__ == "__main__":
    main()
