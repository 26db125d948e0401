"""The shadow of a fan: four blades that turn under a ceiling, out of sight, and a floor with a few things that rest."""

import math

from .native import Mesh, Scene
from .shapes import box, flat, sphere

KEYS, TURN = 9, math.radians(70)  # while the shutter is open
HEIGHT, INNER, OUTER, WIDTH, PITCH = 3.6, 0.25, 1.7, 0.34, 0.1


def blade(angle, key):
    """Four corners of a blade, at a key."""
    turned = angle + TURN * key / (KEYS - 1)
    along, across = (math.cos(turned), math.sin(turned)), (-math.sin(turned), math.cos(turned))
    return [(r * along[0] + w * across[0], HEIGHT + PITCH * w / WIDTH, r * along[1] + w * across[1])
            for r, w in ((INNER, -0.6 * WIDTH / 2), (OUTER, -WIDTH / 2), (OUTER, WIDTH / 2), (INNER, 0.6 * WIDTH / 2))]


def make(folder, options):
    scene = Scene(folder, 640, 360)
    scene.camera(34, ((0.3, 2.7, 4.3), (0.3, 0.05, -0.2)))
    scene.set(background=[0.05, 0.06, 0.08])
    scene.light("directional", direction=[0.1, -1.0, -0.12], irradiance=[3.2, 3.0, 2.6])
    scene.light("point", position=[-3.0, 3.0, 5.0], intensity=[9.0, 10.5, 13.0])
    blades = Mesh("blades", scene.material("blades", (0.5, 0.3, 0.15)), KEYS)
    for i in range(4):
        blades.add([blade(i * math.pi / 2, key) for key in range(KEYS)], [(0, 1, 2), (0, 2, 3)])
    floor = Mesh("floor", scene.material("floor", (0.62, 0.56, 0.48)), smooth=True)
    flat(floor, [(-9, 0, 9), (9, 0, 9), (9, 0, -9), (-9, 0, -9)])
    crate = Mesh("crate", scene.material("crate", (0.35, 0.45, 0.55)), smooth=True)
    box(crate, (-1.25, 0, -0.7), (-0.55, 0.5, 0.0))
    balls = Mesh("balls", scene.material("balls", (0.7, 0.25, 0.15)), smooth=True)
    sphere(balls, (1.1, 0.32, 0.0), 0.32)
    sphere(balls, (0.45, 0.18, 0.75), 0.18)
    for mesh in (blades, floor, crate, balls):
        scene.mesh(mesh)
    return scene
