"""A hundred million triangles of trees, of which few are the files' own: three kinds, five thousand copies. Half of them
sway in the wind, and the camera flies over them.
"""

import math
import random

from . import plants
from .native import Mesh, Scene, many
from .shapes import ground

COUNT = 5000
LEAVES = 10000  # of a tree, two triangles each
DEEP = 260.0


def make(folder, options):
    rng = random.Random(100)
    scene = Scene(folder, 480, 480)
    scene.camera(45, ((0.0, 15.0, 12.0), (0.0, 4.0, -30.0)), ((0.6, 15.1, 11.0), (0.8, 4.0, -31.0)))
    scene.set(background=[0.62, 0.74, 0.90])
    scene.light("directional", direction=[-0.6, -0.6, -0.3], irradiance=[3.0, 2.8, 2.4])
    scene.light("constant", radiance=[0.32, 0.38, 0.48])
    earth = Mesh("earth", scene.material("earth", (0.16, 0.17, 0.08)), smooth=True)
    ground(earth, 600.0, 0.0)
    scene.mesh(earth)
    bark = scene.material("bark", (0.20, 0.14, 0.09))
    kinds = []
    for i, colour in enumerate([(0.09, 0.24, 0.06), (0.15, 0.30, 0.07), (0.28, 0.32, 0.09)]):
        crown = Mesh(f"crown{i}_", scene.material(f"leaves{i}", colour))
        plants.crown(crown, rng, LEAVES, 5.0 + i, 2.0, 0.22)
        wood = Mesh(f"wood{i}_", bark, smooth=True)
        plants.trunk(wood, rng, 5.0 + i, 2.0, 20)
        kinds.append((crown, wood))
    places = [[] for _ in kinds]
    for i in range(many(COUNT, options.scale)):
        depth = 4.0 + DEEP * rng.random() ** 0.6
        x, z = rng.uniform(-1, 1) * (10.0 + 0.55 * depth), 12.0 - depth
        size, turn = rng.uniform(0.7, 1.3), rng.uniform(0, math.tau)
        still = plants.placed(x, 0.0, z, size, turn)
        if i % 2:
            phase, push = 0.2 * x + 0.1 * z, rng.uniform(0.01, 0.03)
            lean = [(push * math.sin(phase + step), 0.4 * push * math.sin(phase + step)) for step in (0.0, 1.5)]
            places[i % len(kinds)].append([plants.placed(x, 0.0, z, size, turn, bent) for bent in lean])
        else:
            places[i % len(kinds)].append(still)
    for (crown, wood), matrices in zip(kinds, places):
        for mesh in (crown, wood):
            scene.copies(mesh, mesh.write(folder), matrices)
    return scene
