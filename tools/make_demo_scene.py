#!/usr/bin/env python3
"""Writes the demo scene as an animated binary glTF file. The same bytes every time.

Usage: make_demo_scene.py OUT.glb

Two seconds, 48 frames at 24 a second; the demo shows frame 24. Everything that glTF has to make things move is in it:
node translations and rotations (LINEAR and CUBICSPLINE), morph targets, a skin, and a second camera that travels.
"""

import sys

from demo_scene import glb, moving, square
from demo_scene.maths import look_at

ASPECT = 16 / 9


def add_cameras(file):
    eye, target = (0.35, 1.75, 9.3), (0.35, 2.5, 0.0)
    file.camera("square", 38, ASPECT, translation=eye, rotation=look_at(eye, target))
    times = [moving.DURATION * i / 12 for i in range(13)]
    eyes = [(-3.0 + 5.5 * time / moving.DURATION, 1.2 + 0.9 * time, 9.5 - 0.8 * time) for time in times]
    travelling = file.camera("travelling", 40, ASPECT)
    file.animate(travelling, "translation", times, eyes)
    file.animate(travelling, "rotation", times, [look_at(eye, (0.3, 2.4, -1.0)) for eye in eyes])


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: make_demo_scene.py OUT.glb")
    file = glb.File()
    add_cameras(file)
    static = square.make_square()
    moving.add_wheel(file)
    moving.add_windmill(file, static, square.add_pole)
    moving.add_pinwheels(file, static, square.add_pole)
    square.add_pole(static, -2.75, -2.5, 5.25)
    moving.add_flag(file, "flag", (-2.72, 5.2, -2.5), 2.1, 1.25, 3.0, [moving.VERMILION, moving.CREAM] * 3)
    tower_top = square.add_tower(static, (2.3, 0, -42), 0.9)
    moving.add_flag(file, "pennant", (2.3, tower_top, -42), 3.2, 1.1, 4.0, [moving.VERMILION], 24, 6)
    moving.add_birds(file)
    moving.add_kite(file)
    file.node("square", mesh=file.mesh(static))
    file.write(sys.argv[1])


if __name__ == "__main__":
    main()
