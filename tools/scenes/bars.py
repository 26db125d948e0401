"""Slats that fly along themselves, a little aslant: their long edges stay where they are while the short ends blur."""

import math

from .native import Mesh, Scene

COLORS = [(0.92, 0.35, 0.12), (0.95, 0.90, 0.80), (0.20, 0.45, 0.75)]
COUNT, LONG, THICK, APART, FAR = 9, 2.6, 0.13, 0.36, 1.4
ASLANT = math.radians(7)


def make(folder, options):
    scene = Scene(folder, 640, 360)
    scene.camera(40, ((0, 0, 5), (0, 0, 0)))
    meshes = [Mesh(f"bars{i}", scene.material(f"bars{i}", color), keys=2) for i, color in enumerate(COLORS)]
    along, across = (math.cos(ASLANT), math.sin(ASLANT)), (-math.sin(ASLANT), math.cos(ASLANT))
    for i in range(COUNT):
        begin = -LONG / 2 - FAR / 2 + 0.5 * ((i * 5) % 4 - 1.5)
        low = APART * (i - (COUNT - 1) / 2) - THICK / 2
        keys = [[(a * along[0] + b * across[0], a * along[1] + b * across[1], 0)
                 for a, b in ((start, low), (start + LONG, low), (start + LONG, low + THICK), (start, low + THICK))]
                for start in (begin, begin + FAR)]
        meshes[i % len(meshes)].add(keys, [(0, 1, 2), (0, 2, 3)])
    for mesh in meshes:
        scene.mesh(mesh)
    return scene
