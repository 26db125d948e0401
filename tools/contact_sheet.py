#!/usr/bin/env python3
"""Renders models as they come, each with nothing but a size and a frame, onto one sheet: what does Kairos make of files?

Usage: contact_sheet.py KAIROS OUT.png FOLDER... [--size WxH] [--spp N] [--columns N]

Looks for the models of MODELS in the folders and everything below; prints what is not there and leaves it out. Debian's
package assimp-testmodels puts some into /usr/share/assimp/models; those of the Khronos group are at
github.com/KhronosGroup/glTF-Sample-Assets.
"""

import argparse
import pathlib
import struct
import subprocess
import sys
import tempfile
import zlib

# How a model's path ends, and what its moment and view are, where the first camera and the beginning are not the best.
MODELS = [
    ("Barbarian.glb", ["--frame", "5"]),
    ("mannequiny.glb", ["--frame", "8"]),
    ("robot.glb", ["--frame", "10"]),
    ("CesiumMan.glb", ["--frame", "10", "--shutter", "0,1"]),
    ("Fox/Fox.glb", ["--frame", "4", "--shutter", "0,1"]),
    ("RiggedFigure.glb", ["--frame", "12", "--shutter", "0,2"]),
    ("ToyCar.gltf", []),
    ("CesiumMilkTruck.glb", ["--frame", "10", "--shutter", "0,1"]),
    ("dutch_ship_medium_1k.gltf", []),
    ("vintageFan_animated.gltf", ["--frame", "4"]),
    ("SheenCloth.gltf", []),
    ("MetalRoughSpheresNoTextures.glb", []),
    ("MorphStressTest.glb", ["--frame", "20", "--shutter", "0,1"]),
    ("RecursiveSkeletons.glb", ["--frame", "20", "--shutter", "0,2"]),
    ("InterpolationTest.glb", ["--frame", "8", "--shutter", "0,2"]),
    ("AnimatedMorphCube.glb", ["--frame", "20"]),
    ("AnimatedCube.gltf", ["--frame", "8", "--shutter", "0,2"]),
    ("RiggedSimple.glb", ["--frame", "20", "--shutter", "0,2"]),
    ("2CylinderEngine.glb", []),
    ("ClearCoatTest.gltf", []),
    ("TextureTransformTest.gltf", []),
    ("WusonOBJ.obj", []),
    ("spider.obj", []),
    ("cube_with_vertexcolors.obj", []),
]
GAP = 4  # pixels between pictures, white


def read_png(path):
    """Width, height and rows of red, green, blue: PNGs of 8 bits without interlacing, as Kairos writes them."""
    data = path.read_bytes()
    position, packed = 8, b""
    while position < len(data):
        size, kind = struct.unpack_from(">I4s", data, position)
        body = data[position + 8:position + 8 + size]
        if kind == b"IHDR":
            width, height, depth, colours, _, _, interlaced = struct.unpack(">IIBBBBB", body)
            if (depth, colours, interlaced) != (8, 2, 0):
                sys.exit(f"{path}: not a PNG of 8 bits in red, green and blue")
        elif kind == b"IDAT":
            packed += body
        position += 12 + size
    raw, stride = zlib.decompress(packed), 3 * width
    rows, above = [], bytearray(stride)
    for y in range(height):
        method, row = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for i in range(stride):
            left, up, corner = (row[i - 3] if i > 2 else 0), above[i], (above[i - 3] if i > 2 else 0)
            if method == 1:
                guess = left
            elif method == 2:
                guess = up
            elif method == 3:
                guess = (left + up) // 2
            elif method == 4:  # whichever of the three is nearest to left + up - corner
                estimate = left + up - corner
                guess = min((abs(estimate - left), 0, left), (abs(estimate - up), 1, up),
                            (abs(estimate - corner), 2, corner))[2]
            else:
                guess = 0
            row[i] = (row[i] + guess) & 255
        rows.append(row)
        above = row
    return width, height, rows


def write_png(path, width, rows):
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    packed, above = bytearray(), bytearray(3 * width)
    for row in rows:  # what changes from the row above compresses well
        packed += b"\2" + bytes((a - b) & 255 for a, b in zip(row, above))
        above = row
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, len(rows), 8, 2, 0, 0, 0)) +
                     chunk(b"IDAT", zlib.compress(bytes(packed), 9)) + chunk(b"IEND", b""))


def find(model, folders):
    for folder in folders:
        found = sorted(path for path in folder.rglob(model.split("/")[-1]) if path.match(model))
        if found:
            return found[0]
    return None


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("kairos", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("folders", type=pathlib.Path, nargs="+")
    parser.add_argument("--size", default="240x180")
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--columns", type=int, default=6)
    arguments = parser.parse_args()
    width, height = (int(side) for side in arguments.size.split("x"))
    pictures = []
    with tempfile.TemporaryDirectory() as folder:
        picture = pathlib.Path(folder) / "picture.png"
        for model, options in MODELS:
            path = find(model, arguments.folders)
            if path is None:
                print(f"not there: {model}")
                continue
            subprocess.run([arguments.kairos, "render", path, "-o", picture, "--size", arguments.size, "--spp",
                            str(arguments.spp), "--quiet", *options], check=True)
            pictures.append(read_png(picture)[2])
            print(f"{len(pictures)}: {path.name}", flush=True)
    if not pictures:
        sys.exit("none of the models is there")
    columns = min(arguments.columns, len(pictures))
    gap, total = bytes([255]) * (3 * GAP), columns * (width + GAP) - GAP
    rows = []
    for first in range(0, len(pictures), columns):
        line = pictures[first:first + columns]
        line += [[bytes([255]) * (3 * width)] * height] * (columns - len(line))
        rows += [bytes([255]) * (3 * total)] * (GAP if first else 0)
        rows += [gap.join(bytes(picture[y]) for picture in line) for y in range(height)]
    write_png(arguments.out, total, rows)
    print(f"{len(pictures)} of {len(MODELS)} models: wrote {arguments.out}")


if __name__ == "__main__":
    main()
