#!/usr/bin/env python3
"""How much noise flickers: a sequence of the demo scene with time-continuous and with discrete rays in equal time.

    tools/sequence_study.py KAIROS DEMO.glb OUT_FOLDER [--frames 18-29] [--size 320x180] [--tc-rays N,N...]

Renders a reference (discrete, another seed), then for each number of time-continuous rays that sequence and one with as
many discrete samples as take the same processor time. Prints a table, writes OUT_FOLDER/strip.png. Goes on where it was
interrupted, as far as the reference is concerned. Needs Python's standard library only.
"""

import argparse
import pathlib
import re
import resource
import struct
import subprocess
import zlib

SHOT = ["--camera", "square", "--shutter", "0,0.5", "--shading", "flat", "--quiet", "--threads", "1"]
BOX = (0.64, 0.06, 0.25, 0.42)  # what the strip shows: x, y, width, height as shares of the picture's
ZOOM, SHOWN = 2, 4  # magnification; how many frames


def processor_seconds():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


class Study:
    def __init__(self, arguments):
        self.arguments, self.out = arguments, arguments.out
        self.out.mkdir(parents=True, exist_ok=True)

    def render(self, name, *options):
        """Returns processor seconds, loading and building included."""
        before = processor_seconds()
        subprocess.run([self.arguments.kairos, "render", self.arguments.scene, "-o", self.out / f"{name}_%04d.exr",
                        "--frames", self.arguments.frames, "--size", self.arguments.size, *SHOT, *options], check=True)
        return processor_seconds() - before

    def fresh(self, name, *options):
        for old in self.out.glob(f"{name}_*.exr"):
            old.unlink()
        return self.render(name, *options)

    def match(self, seconds, name):
        """Discrete samples that take as long, and how long they took."""
        spp, best = 16, None
        for _ in range(5):
            took = self.fresh(name, "--integrator", "qmc", "--spp", str(spp))
            if best is None or abs(took / seconds - 1) < abs(best[1] / seconds - 1):
                best = (spp, took)
            wanted = max(1, round(spp * min(seconds / took, 8)))
            if abs(took / seconds - 1) < 0.04 or wanted == spp:
                break
            spp = wanted
        if spp != best[0]:
            self.fresh(name, "--integrator", "qmc", "--spp", str(best[0]))
        return best

    def compare(self, name):
        done = subprocess.run([self.arguments.kairos, "compare", "--frames", self.arguments.frames,
                               self.out / "reference_%04d.exr", self.out / f"{name}_%04d.exr"], check=True,
                              stdout=subprocess.PIPE, text=True)
        return tuple(float(number) for number in re.search(r"PSNR (\S+) dB, flicker (\S+)", done.stdout).groups())

    def crop(self, name, frame):
        """Rows of (r, g, b) bytes of the strip's part of a picture."""
        source, png = self.out / f"{name}_{frame:04}.exr", self.out / "crop.png"
        subprocess.run([self.arguments.kairos, "compare", source, source, "--side-by-side", png], check=True,
                       stdout=subprocess.DEVNULL)
        rows = read_png(png)
        png.unlink()
        width, height = len(rows[0]) // 3, len(rows)
        x, w = round(BOX[0] * width), round(BOX[2] * width)
        y, h = round(BOX[1] * height), round(BOX[3] * height)
        return [row[3 * x:3 * (x + w)] for row in rows[y:y + h]]

    def strip(self, names, frames):
        """A row per name, a column per frame."""
        picture = []
        for name in names:
            crops = [self.crop(name, frame) for frame in frames]
            for lines in zip(*crops):
                line = b"\xff" * 6
                for part in lines:
                    line += b"".join(part[i:i + 3] * ZOOM for i in range(0, len(part), 3)) + b"\xff" * 6
                picture += [line] * ZOOM
            picture += [b"\xff" * len(picture[0])] * 2
        write_png(self.out / "strip.png", picture)


def read_png(path):
    """8 bits, RGB, not interlaced: what kairos writes."""
    data, position, packed = path.read_bytes(), 8, b""
    while position < len(data):
        length, kind = struct.unpack_from(">I4s", data, position)
        body = data[position + 8:position + 8 + length]
        if kind == b"IHDR":
            width, height = struct.unpack_from(">II", body)
        elif kind == b"IDAT":
            packed += body
        position += 12 + length
    raw, rows, above = zlib.decompress(packed), [], bytes(3 * width)
    for y in range(height):
        kind, line = raw[y * (3 * width + 1)], bytearray(raw[y * (3 * width + 1) + 1:(y + 1) * (3 * width + 1)])
        for i in range(3 * width):
            a, b, c = (line[i - 3], above[i], above[i - 3]) if i >= 3 else (0, above[i], 0)
            near = min((a, b, c), key=lambda value: abs(a + b - c - value))  # the first of equals, as PNG wants it
            line[i] = (line[i] + (0, a, b, (a + b) // 2, near)[kind]) & 255
        rows.append(bytes(line))
        above = rows[-1]
    return rows


def write_png(path, rows):
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    header = struct.pack(">IIBBBBB", len(rows[0]) // 3, len(rows), 8, 2, 0, 0, 0)
    body = zlib.compress(b"".join(b"\0" + row for row in rows), 9)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", body) + chunk(b"IEND", b""))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kairos", type=pathlib.Path)
    parser.add_argument("scene", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--frames", default="18-29")
    parser.add_argument("--size", default="320x180")
    parser.add_argument("--tc-rays", default="4,16")
    parser.add_argument("--reference-spp", type=int, default=1024)
    arguments = parser.parse_args()
    study = Study(arguments)
    study.render("reference", "--integrator", "qmc", "--spp", str(arguments.reference_spp), "--seed", "7")
    print("| rays or samples | processor time | PSNR | flicker |\n| --- | --- | --- | --- |")
    for rays in arguments.tc_rays.split(","):
        seconds = study.fresh(f"tc{rays}", "--integrator", "tc", "--tc-rays", rays)
        spp, took = study.match(seconds, f"qmc{rays}")
        for label, name, time in ((f"{rays} time-continuous", f"tc{rays}", seconds),
                                  (f"{spp} discrete", f"qmc{rays}", took)):
            psnr, flicker = study.compare(name)
            print(f"| {label} | {time:.1f} s | {psnr:.2f} dB | {flicker:.5f} |", flush=True)
    first, last = (int(frame) for frame in arguments.frames.split("-"))
    shown = range(first, min(last, first + SHOWN - 1) + 1)
    rays = arguments.tc_rays.split(",")[0]
    study.strip([f"qmc{rays}", f"tc{rays}", "reference"], shown)


if __name__ == "__main__":
    main()
