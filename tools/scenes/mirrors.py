"""Two fans that are seen by way of things that rest: one in a mirror, itself out of sight, and one behind a pane of glass."""

import math

from .native import Mesh, Scene
from .shapes import box, flat, sphere

KEYS, TURN = 9, math.radians(70)  # while the shutter is open
INNER, WIDTH, PITCH, BLADES = 0.12, 0.3, 0.08, 5


def fan(scene, name, colour, centre, radius):
    """Turns about z."""
    mesh = Mesh(name, scene.material(name, colour), KEYS)
    for i in range(BLADES):
        def corners(key, angle=math.tau * i / BLADES):
            turned = angle + TURN * key / (KEYS - 1)
            c, s = math.cos(turned), math.sin(turned)
            return [(centre[0] + r * c - w * s, centre[1] + r * s + w * c, centre[2] + PITCH * w / WIDTH)
                    for r, w in ((INNER, -0.2 * WIDTH), (radius, -WIDTH / 2), (radius, WIDTH / 2), (INNER, 0.2 * WIDTH))]
        mesh.add([corners(key) for key in range(KEYS)], [(0, 1, 2), (0, 2, 3)])
    return mesh


def make(folder, options):
    scene = Scene(folder, 640, 360)
    scene.camera(36, ((0.0, 1.3, 4.0), (0.0, 1.05, -1.5)))
    scene.set(background=[0.05, 0.06, 0.08])
    scene.light("directional", direction=[0.35, -1.0, -0.6], irradiance=[2.6, 2.4, 2.1])
    scene.light("point", position=[-1.0, 3.0, 3.5], intensity=[8.0, 9.0, 11.0])
    floor = Mesh("floor", scene.material("floor", (0.52, 0.46, 0.40)), smooth=True)
    flat(floor, [(-9, 0, 9), (9, 0, 9), (9, 0, -9), (-9, 0, -9)])
    wall = Mesh("wall", scene.material("wall", (0.55, 0.60, 0.58)), smooth=True)
    flat(wall, [(-9, 0, -1.55), (9, 0, -1.55), (9, 5, -1.55), (-9, 5, -1.55)])
    mirror = Mesh("mirror", scene.material("silver", (0.92, 0.92, 0.92), metallic=1, roughness=0), smooth=True)
    flat(mirror, [(-2.3, 0.2, -1.5), (-0.15, 0.2, -1.5), (-0.15, 2.25, -1.5), (-2.3, 2.25, -1.5)])
    pane = Mesh("pane", scene.material("glass", (1, 1, 1), roughness=0, transmission=1, ior=1.5), smooth=True)
    box(pane, (0.25, 0.2, -0.45), (2.1, 2.2, -0.37))
    balls = Mesh("balls", scene.material("balls", (0.7, 0.25, 0.15)), smooth=True)
    sphere(balls, (0.0, 0.22, -0.6), 0.22)
    sphere(balls, (-1.5, 0.3, 2.2), 0.3)
    for mesh in (floor, wall, mirror, pane, balls, fan(scene, "mirrored fan", (0.75, 0.55, 0.2), (-2.4, 1.3, 3.0), 1.0),
                 fan(scene, "fan", (0.3, 0.5, 0.7), (1.15, 1.15, -0.95), 0.85)):
        scene.mesh(mesh)
    return scene
