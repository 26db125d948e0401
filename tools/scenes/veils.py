"""Smoke: fifty layers of soft, half transparent cards, one behind the other, that drift and swell."""

import math
import random

from demo_scene.maths import add, mul

from .native import Mesh, Scene, many, write_gray_png
from .shapes import box, ground

LAYERS = 50


def puff(rng, size=64):
    """Opacity of a cloud: soft at its rim, uneven inside."""
    waves = [(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(0, math.tau)) for _ in range(7)]
    rows = []
    for j in range(size):
        row = []
        for i in range(size):
            x, y = 2 * (i + 0.5) / size - 1, 2 * (j + 0.5) / size - 1
            rough = sum(math.sin(6 * (a * x + b * y) + c) for a, b, c in waves) / len(waves)
            row.append(int(255 * max(0.0, 1 - math.hypot(x, y)) * max(0.0, 0.75 + 0.5 * rough)))
        rows.append(row)
    return rows


def make(folder, options):
    rng = random.Random(50)
    scene = Scene(folder, 480, 480)
    scene.camera(40, ((0.0, 1.2, 6.0), (0.0, 1.3, 0.0)))
    scene.set(background=[0.30, 0.42, 0.60])
    scene.light("directional", direction=[-0.4, -0.8, -0.4], irradiance=[2.6, 2.5, 2.3])
    scene.light("constant", radiance=[0.4, 0.42, 0.46])
    yard = Mesh("yard", scene.material("yard", (0.30, 0.27, 0.22)), smooth=True)
    ground(yard, 30.0, 0.0)
    box(yard, (-0.5, 0.0, -4.6), (0.5, 1.0, -3.6))
    scene.mesh(yard)
    for i in range(4):
        write_gray_png(folder / f"puff{i}.png", puff(rng))
    smoke = [scene.material(f"smoke{i}", (0.55 + 0.08 * i,) * 3, alpha=0.45, alpha_texture=f"puff{i}.png") for i in range(4)]
    veils = [Mesh(f"veils{i}", material, keys=2, pictured=True) for i, material in enumerate(smoke)]
    for layer in range(many(LAYERS, options.scale)):
        depth = -3.0 + 6.0 * (layer + rng.random()) / many(LAYERS, options.scale)
        center = (rng.uniform(-0.5, 0.5), 1.4 + rng.uniform(-0.5, 0.5), depth)
        drift = (rng.uniform(0.05, 0.3), rng.uniform(0.1, 0.35), rng.uniform(-0.05, 0.05))
        size, spin = rng.uniform(1.1, 1.9), rng.uniform(0, math.tau)
        keys = []
        for time in (0.0, 1.0):
            angle, half = spin + 0.12 * time, size * (1 + 0.06 * time)
            corners = []
            for s, t in ((0, 0), (1, 0), (1, 1), (0, 1)):
                x, y = half * (2 * s - 1), half * (2 * t - 1)
                offset = (x * math.cos(angle) - y * math.sin(angle), x * math.sin(angle) + y * math.cos(angle), 0.0)
                corners.append((*add(add(center, mul(drift, time)), offset), s, t))
            keys.append(corners)
        veils[layer % len(veils)].add(keys, [(0, 1, 2), (0, 2, 3)])
    for mesh in veils:
        scene.mesh(mesh)
    return scene
