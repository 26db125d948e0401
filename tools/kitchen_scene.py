#!/usr/bin/env python3
"""Writes a native scene with a moving camera from a pbrt-v3 scene made of PLY meshes.

    tools/kitchen_scene.py PBRT_FOLDER OUT_FOLDER [--move RIGHT,UP,FORWARD] [--pan DEGREES]

Reads PBRT_FOLDER/scene.pbrt as far as that takes: the camera, transforms, plymesh shapes and one colour per named
material. Writes OUT_FOLDER/scene.json and copies the meshes to OUT_FOLDER/models. While the shutter is open, the camera
moves by --move (metres, along its own axes) and turns right by --pan. The default makes everything move by several
pixels in a picture of 960x540. Meant for B. Bitterli's "kitchen"; needs Python's standard library only.
"""

import argparse
import json
import math
import pathlib
import re
import shutil
import sys

IDENTITY = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]  # 4x4 matrices: 16 numbers, column after column
MIRROR_X = [-1] + IDENTITY[1:]


def multiply(a, b):
    return [sum(a[4 * k + row] * b[4 * col + k] for k in range(4)) for col in range(4) for row in range(4)]


def apply(m, v, w):
    """The point (w = 1) or direction (w = 0) v, transformed."""
    return [sum(m[4 * k + row] * v[k] for k in range(3)) + w * m[12 + row] for row in range(3)]


def add(a, b, scale=1.0):
    return [x + scale * y for x, y in zip(a, b)]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def normalize(a):
    return [x / math.sqrt(dot(a, a)) for x in a]


def determinant(m):
    return dot(m[0:3], cross(m[4:7], m[8:11]))


def inverse(m):
    """Of an affine matrix."""
    x, y, z, t = m[0:3], m[4:7], m[8:11], m[12:15]
    det = determinant(m)
    rows = [[c / det for c in cross(y, z)], [c / det for c in cross(z, x)], [c / det for c in cross(x, y)]]
    columns = [[row[k] for row in rows] + [0] for k in range(3)]
    return columns[0] + columns[1] + columns[2] + [-dot(row, t) for row in rows] + [1]


def translate(v):
    return IDENTITY[:12] + list(v) + [1]


def scale(v):
    return [v[0], 0, 0, 0, 0, v[1], 0, 0, 0, 0, v[2], 0, 0, 0, 0, 1]


def rotate(degrees, axis):
    a, s, c = normalize(axis), math.sin(math.radians(degrees)), math.cos(math.radians(degrees))
    columns = []
    for k in range(3):
        e = [1.0 if i == k else 0.0 for i in range(3)]
        parallel = [dot(a, e) * x for x in a]
        columns += add(add(parallel, add(e, parallel, -1), c), cross(a, e), s) + [0]
    return columns + [0, 0, 0, 1]


def look_at(eye, target, up):
    """pbrt's: camera from world, left-handed, looking along +z."""
    forward = normalize(add(target, eye, -1))
    right = normalize(cross(normalize(up), forward))
    return inverse(right + [0] + cross(forward, right) + [0] + forward + [0] + list(eye) + [1])


class Pbrt:
    """What a scene file leaves behind, one directive after the other."""

    def __init__(self, text):
        self.tokens = re.findall(r'#[^\n]*|"[^"]*"|\[|\]|[^\s\[\]"#]+', text)
        self.tokens = [token for token in self.tokens if not token.startswith("#")]
        self.position = 0
        self.transform, self.material = IDENTITY, None
        self.stack = []
        self.camera_from_world, self.fov, self.resolution = None, 90.0, (1280, 720)
        self.colors, self.shapes, self.passed_over = {}, [], {}
        while self.position < len(self.tokens):
            self.directive(self.take())

    def take(self):
        self.position += 1
        return self.tokens[self.position - 1]

    def numbers(self, count):
        values = []
        while len(values) < count:
            token = self.take()
            if token not in "[]":
                values.append(float(token))
        if self.position < len(self.tokens) and self.tokens[self.position] == "]":
            self.take()
        return values

    def string(self):
        return self.take().strip('"')

    def parameters(self):
        """{name: (type, values)} of the list that ends a directive."""
        found = {}
        while self.position < len(self.tokens) and self.tokens[self.position].startswith('"'):
            kind, name = self.string().split()
            values = []
            if self.tokens[self.position] == "[":
                self.take()
                while self.tokens[self.position] != "]":
                    values.append(self.take())
                self.take()
            else:
                values.append(self.take())
            found[name] = (kind, [value.strip('"') for value in values])
        return found

    def directive(self, name):
        if name in ("Transform", "ConcatTransform"):
            matrix = self.numbers(16)
            self.transform = matrix if name == "Transform" else multiply(self.transform, matrix)
        elif name == "Identity":
            self.transform = IDENTITY
        elif name == "Translate":
            self.transform = multiply(self.transform, translate(self.numbers(3)))
        elif name == "Scale":
            self.transform = multiply(self.transform, scale(self.numbers(3)))
        elif name == "Rotate":
            degrees, *axis = self.numbers(4)
            self.transform = multiply(self.transform, rotate(degrees, axis))
        elif name == "LookAt":
            v = self.numbers(9)
            self.transform = multiply(self.transform, look_at(v[0:3], v[3:6], v[6:9]))
        elif name in ("AttributeBegin", "TransformBegin"):
            self.stack.append((self.transform, self.material))
        elif name in ("AttributeEnd", "TransformEnd"):
            transform, material = self.stack.pop()
            self.transform = transform
            if name == "AttributeEnd":
                self.material = material
        elif name == "WorldBegin":
            self.transform = IDENTITY
        elif name in ("WorldEnd", "ReverseOrientation"):
            pass
        elif name in ("Include", "ObjectBegin", "ObjectInstance"):
            sys.exit(f"{name} is not understood by this program")
        elif name == "NamedMaterial":
            self.material = self.string()
        elif name == "Camera":
            self.string()
            self.camera_from_world = self.transform
            self.fov = float(self.parameters().get("fov", ("float", ["90"]))[1][0])
        elif name == "Film":
            self.string()
            film = self.parameters()
            self.resolution = tuple(int(film[f"{axis}resolution"][1][0]) for axis in "xy")
        elif name == "MakeNamedMaterial":
            material = self.string()
            self.colors[material] = color_of(self.parameters())
        elif name == "Shape":
            kind, values = self.string(), self.parameters()
            if kind == "plymesh":
                self.shapes.append((values["filename"][1][0], self.transform, self.material))
            else:
                self.passed_over[kind] = self.passed_over.get(kind, 0) + 1
        else:  # Integrator, Sampler, Texture, ...: strings, then parameters
            self.string()
            while self.tokens[self.position].startswith('"') and " " not in self.tokens[self.position]:
                self.take()
            self.parameters()


def color_of(material):
    """The diffuse colour; a metal's reflectance at right angles; grey where a texture would be needed."""

    def rgb(name):
        kind, values = material.get(name, ("", []))
        return [float(value) for value in values] if kind in ("rgb", "color") else None

    eta, k = rgb("eta"), rgb("k")
    if eta and k:
        return [((n - 1) ** 2 + x * x) / ((n + 1) ** 2 + x * x) for n, x in zip(eta, k)]
    return rgb("Kd") or [0.5, 0.5, 0.5]


def camera_keys(camera_from_world, mirrored, move, pan):
    """pbrt's camera looks along its +z with x to the right and y up."""
    world_from_camera = inverse(camera_from_world)
    if mirrored:
        world_from_camera = multiply(MIRROR_X, world_from_camera)
    eye = apply(world_from_camera, [0, 0, 0], 1)
    right, up, forward = (normalize(apply(world_from_camera, axis, 0)) for axis in ([1, 0, 0], [0, 1, 0], [0, 0, 1]))
    distance = 4.0  # of the point looked at
    turned = add([math.cos(math.radians(pan)) * x for x in forward], right, math.sin(math.radians(pan)))
    moved = add(add(add(eye, right, move[0]), up, move[1]), forward, move[2])
    return [
        {"time": 0, "eye": eye, "target": add(eye, forward, distance), "up": up},
        {"time": 1, "eye": moved, "target": add(moved, turned, distance), "up": up},
    ]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pbrt_folder", type=pathlib.Path)
    parser.add_argument("out_folder", type=pathlib.Path)
    parser.add_argument("--move", default="0.03,0.006,0.03", help="metres to the right, up and forward (%(default)s)")
    parser.add_argument("--pan", type=float, default=0.3, help="degrees to the right (%(default)s)")
    arguments = parser.parse_args()
    move = [float(value) for value in arguments.move.split(",")]
    if len(move) != 3:
        parser.error("--move takes three numbers")

    scene_file = arguments.pbrt_folder / "scene.pbrt"
    if not scene_file.is_file():
        sys.exit(f"{scene_file}: no such file")
    pbrt = Pbrt(scene_file.read_text())
    if pbrt.camera_from_world is None or not pbrt.shapes:
        sys.exit(f"{scene_file}: has no camera or no plymesh")

    # pbrt's camera space is left-handed. When the way there from the world does not mirror, the world is left-handed
    # too, and ours is its mirror image.
    mirrored = determinant(pbrt.camera_from_world) > 0
    width, height = pbrt.resolution
    half = math.tan(math.radians(pbrt.fov) / 2)  # pbrt's fov is that of the shorter side
    vfov = 2 * math.degrees(math.atan(half * max(1, height / width)))

    (arguments.out_folder / "models").mkdir(parents=True, exist_ok=True)
    meshes, copied = [], {}
    for filename, transform, material in pbrt.shapes:
        source = arguments.pbrt_folder / filename
        target = copied.setdefault(source, f"models/{len(copied):03}_{source.name}")
        shutil.copyfile(source, arguments.out_folder / target)
        mesh = {"name": source.stem, "keys": [target]}
        if material in pbrt.colors:
            mesh["material"] = material
        if mirrored:
            transform = multiply(MIRROR_X, transform)
        if transform != IDENTITY:
            mesh["transform"] = {"matrix": transform}
        meshes.append(mesh)

    scene = {
        "kairos": 1,
        "image": {"width": 960, "height": max(1, round(960 * height / width))},
        "shutter": [0, 1],
        "camera": {
            "vfov_degrees": vfov,
            "keys": camera_keys(pbrt.camera_from_world, mirrored, move, arguments.pan),
        },
        "materials": {name: {"base_color": color} for name, color in pbrt.colors.items()},
        "meshes": meshes,
    }
    out_file = arguments.out_folder / "scene.json"
    out_file.write_text(json.dumps(scene, indent=1))
    for kind, count in pbrt.passed_over.items():
        print(f"passed over: {count} shapes of kind {kind}")
    print(f"{out_file}: {len(meshes)} meshes")


if __name__ == "__main__":
    main()
