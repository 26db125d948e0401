"""A courtyard full of plants, most of them small, and many of each kind: a million triangles, of which few are the file's
own. Nothing moves but the camera, which travels and turns by --motion pixels.

--leaves says what leaves are: whole (triangles of a leaf's shape), cut (cards with a picture of opacity), or bare (cards
whose picture is not there).
"""

import math
import random

from . import plants
from .native import Mesh, Scene, many, write_gray_png
from .shapes import box, ground, turned

WIDTH = HEIGHT = 480
VFOV = 50.0
EYE, TARGET = (0.0, 1.55, 5.6), (0.0, 0.45, 0.0)
GREENS = [(0.10, 0.26, 0.05), (0.16, 0.34, 0.07), (0.24, 0.42, 0.09), (0.32, 0.40, 0.10), (0.20, 0.30, 0.14)]
PETALS = [(0.62, 0.12, 0.14), (0.72, 0.52, 0.10), (0.52, 0.36, 0.62)]
# Kind: how many, their size. Of about 190 triangles each, in the mean.
COPIES = {"tuft": (2300, 1.0), "herb": (1500, 1.0), "flower": (900, 1.0), "shrub": (220, 1.0), "tree": (10, 1.0)}


def make(folder, options):
    rng = random.Random(2017)
    scene = Scene(folder, WIDTH, HEIGHT)
    pixel = 2 * math.tan(math.radians(VFOV) / 2) / HEIGHT
    # Half of the motion is the way of the eye, half its turn, both as long for what is four metres away.
    way, turn = 0.5 * options.motion * pixel * 4.0, 0.5 * options.motion * pixel * math.dist(EYE, TARGET)
    scene.camera(VFOV, (EYE, TARGET), ((EYE[0] + way, EYE[1], EYE[2]), (TARGET[0] + way + turn, TARGET[1], TARGET[2])))
    scene.set(background=[0.60, 0.72, 0.88])
    scene.light("directional", direction=[-0.55, -0.75, -0.35], irradiance=[3.0, 2.8, 2.4])
    scene.light("constant", radiance=[0.34, 0.40, 0.48])

    cards = options.leaves != "whole"
    picture = {} if not cards else {"alpha_texture": "leaf.png", "alpha_cutoff": 0.5}
    if options.leaves == "cut":
        write_gray_png(folder / "leaf.png", plants.leaf_picture())
    green = [scene.material(f"green{i}", colour, **picture) for i, colour in enumerate(GREENS)]
    petal = [scene.material(f"petal{i}", colour, **picture) for i, colour in enumerate(PETALS)]
    stone, clay = scene.material("stone", (0.46, 0.43, 0.38)), scene.material("clay", (0.45, 0.20, 0.12))
    bark = scene.material("bark", (0.22, 0.15, 0.10))

    yard = Mesh("yard", stone, smooth=True)
    ground(yard, 40.0, 0.0)
    for x0, x1, z0, z1 in ((-7, 7, -7.4, -7), (-7.4, -7, -7, 7), (7, 7.4, -7, 7)):
        box(yard, (x0, 0, z0), (x1, 2.6, z1))
    for i in range(9):
        box(yard, (-6.6 + 1.6 * i, 2.6, -7.5), (-6.2 + 1.6 * i, 3.0, -6.9))
    scene.mesh(yard)
    pot = Mesh("pot", clay, smooth=True)
    turned(pot, (0, 0, 0), [(0.20, 0.0, 0, -1), (0.22, 0.0, 1, 0), (0.32, 0.34, 1, 0), (0.35, 0.36, 0, 1),
                            (0.30, 0.36, 0, 1), (0.28, 0.28, 0, 1), (0.01, 0.28, 0, 1)], sides=24)

    kinds = {}
    for i in range(3):
        made = Mesh(f"tuft{i}_", green[(i + 2) % 5] if not cards else scene.material(f"grass{i}", GREENS[i + 1]))
        plants.tuft(made, rng, 26, 0.22)
        kinds.setdefault("tuft", []).append(made)
        made = Mesh(f"herb{i}_", green[i], pictured=cards)
        plants.shrub(made, rng, 55, 0.12, 0.08)
        kinds.setdefault("herb", []).append(made)
        made = Mesh(f"flower{i}_", petal[i], pictured=cards)
        plants.shrub(made, rng, 80, 0.15, 0.05)
        kinds.setdefault("flower", []).append(made)
        made = Mesh(f"shrub{i}_", green[i + 1], pictured=cards)
        plants.shrub(made, rng, 700, 0.38, 0.09)
        kinds.setdefault("shrub", []).append(made)
    for i in range(2):
        made = Mesh(f"tree{i}_", green[i], pictured=cards)
        plants.crown(made, rng, 9000, 2.1, 0.9, 0.10)
        kinds.setdefault("tree", []).append(made)
    wood = Mesh("wood", bark, smooth=True)
    plants.trunk(wood, rng, 2.0, 0.9, 14)

    pots, trunks = [], []
    for kind, meshes in kinds.items():
        count, size = COPIES[kind]
        places = [[] for _ in meshes]
        for i in range(many(count, options.scale)):
            x, z = rng.uniform(-6.6, 6.6), -6.6 + 11.0 * rng.random() ** 0.8
            if abs(x) < 0.9 and kind != "tuft":  # a path
                x += math.copysign(1.2, x)
            potted = kind in ("shrub", "flower") and rng.random() < 0.35
            if potted:
                pots.append(plants.placed(x, 0, z, 1.0, rng.uniform(0, math.tau)))
            matrix = plants.placed(x, 0.26 if potted else 0.0, z, size * rng.uniform(0.7, 1.25), rng.uniform(0, math.tau))
            places[i % len(meshes)].append(matrix)
            if kind == "tree":
                trunks.append(matrix)
        for mesh, matrices in zip(meshes, places):
            if matrices:
                scene.copies(mesh, mesh.write(folder), matrices)
    scene.copies(pot, pot.write(folder), pots)
    scene.copies(wood, wood.write(folder), trunks)
    return scene
