"""A head of hair that turns: a hundred thousand strands of six triangles, thinner than a pixel, whose tips trail."""

import math
import random

from demo_scene.maths import add, cross, mul, rotate, turn, unit

from .native import Mesh, Scene, many
from .shapes import sphere

STRANDS = 100000
WIDTH = 0.0009  # metres
COLOURS = [(0.20, 0.10, 0.05), (0.28, 0.15, 0.07), (0.38, 0.22, 0.10)]
JOINTS = 4
FACES = [(0, 1, 3), (0, 3, 2), (2, 3, 5), (2, 5, 4), (4, 5, 7), (4, 7, 6)]


def make(folder, options):
    rng = random.Random(100000)
    scene = Scene(folder, 480, 480)
    scene.camera(32, ((0.0, -0.02, 1.1), (0.0, -0.08, 0.0)))
    scene.set(background=[0.62, 0.66, 0.72])
    scene.light("directional", direction=[-0.5, -0.6, -0.6], irradiance=[3.2, 3.0, 2.8])
    scene.light("constant", radiance=[0.35, 0.36, 0.40])
    spans = options.spans
    times = [key / spans for key in range(spans + 1)]
    head = Mesh("head", scene.material("skin", (0.55, 0.36, 0.27)), smooth=True)
    sphere(head, (0, 0, 0), 0.098)
    scene.mesh(head)
    hair = [Mesh(f"hair{i}", scene.material(f"hair{i}", colour), spans + 1) for i, colour in enumerate(COLOURS)]
    for _ in range(many(STRANDS, options.scale)):
        while True:
            out = unit((rng.gauss(0, 1), rng.gauss(0, 1), rng.gauss(0, 1)))
            if out[1] > 0.15 or (out[1] > -0.5 and out[2] < 0.25):
                break
        length, sway = rng.uniform(0.16, 0.30), (rng.gauss(0, 0.02), rng.gauss(0, 0.01), rng.gauss(0, 0.02))
        path = []
        for joint in range(JOINTS):
            share = joint / (JOINTS - 1)
            fall = (out[0] * 0.10 * (1 + share), 0.10 * out[1] - length * share ** 1.3, out[2] * 0.10 * (1 + share))
            path.append(add(add(mul(out, 0.1 * (1 - share)), mul(fall, share)), mul(sway, share)))
        keys = []
        for time in times:
            points = []
            for joint, point in enumerate(path):
                lag = joint / (JOINTS - 1)  # tips follow later
                angle = 24 * max(0.0, time - 0.35 * lag) + 3 * math.sin(5 * time + 2 * lag)
                at = rotate(turn((0, 1, 0), angle), point)
                ahead = path[min(joint + 1, JOINTS - 1)]
                side = unit(cross((ahead[0] - path[max(0, joint - 1)][0], ahead[1] - path[max(0, joint - 1)][1],
                                   ahead[2] - path[max(0, joint - 1)][2]), (0.1, 0.2, 1.0)))
                half = mul(side, 0.5 * WIDTH * (1 - 0.6 * lag))
                points += [add(at, mul(half, -1)), add(at, half)]
            keys.append(points)
        hair[rng.randrange(3)].add(keys, FACES)
    for mesh in hair:
        scene.mesh(mesh)
    return scene
