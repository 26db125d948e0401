"""A whirlwind of straws: 20 000 long and very thin triangles that fly around an axis, far faster than they are wide."""

import math
import random

from demo_scene.maths import add, cross, mul, unit

from .native import Mesh, Scene, many
from .shapes import ground

STRAW = [(0.85, 0.68, 0.32), (0.72, 0.50, 0.18), (0.93, 0.82, 0.52), (0.55, 0.30, 0.12), (0.75, 0.20, 0.08)]


def straw(rng, times):
    """Three corners per key. It flies along a circle; its speed falls off with the distance from the axis."""
    height = 3.4 * rng.random() ** 0.85
    radius = (0.3 + 0.2 * height ** 1.8) * (0.25 + 0.9 * rng.random() ** 0.6)
    angle = rng.uniform(0, math.tau)
    speed = rng.uniform(0.75, 1.25) * 0.55 / math.sqrt(radius + 0.15)  # metres per shutter
    lift = rng.uniform(-0.03, 0.09)
    length, width = rng.uniform(0.15, 0.45), rng.uniform(0.006, 0.014)
    # Most fly with their points ahead and a little askew, as things in a wind do.
    ahead = (-math.sin(angle), 0.0, math.cos(angle))
    along = unit(add(ahead, (rng.gauss(0, 0.55), rng.gauss(0.1, 0.55), rng.gauss(0, 0.55))))
    tumble = tuple(rng.gauss(0, 0.12) for _ in range(3))
    across = mul(unit(cross(along, tuple(rng.gauss(0, 1) for _ in range(3)))), width / 2)
    keys = []
    for time in times:
        turned = angle + speed / radius * time
        center = (radius * math.cos(turned), 0.1 + height + lift * time, radius * math.sin(turned))
        direction = mul(unit(add(along, mul(tumble, time))), length)
        keys.append([add(center, across), add(center, mul(across, -1)), add(center, direction)])
    return keys


def make(folder, options):
    rng = random.Random(20000)
    scene = Scene(folder, 640, 360)
    scene.camera(38, ((0.0, 0.9, 5.8), (0.0, 1.7, 0.0)))
    scene.set(background=[0.10, 0.14, 0.20])
    scene.light("directional", direction=[-0.6, -0.7, -0.5], irradiance=[3.4, 3.0, 2.4])
    scene.light("constant", radiance=[0.30, 0.34, 0.40])
    times = [key / options.spans for key in range(options.spans + 1)]
    meshes = [Mesh(f"straw{i}", scene.material(f"straw{i}", color), len(times)) for i, color in enumerate(STRAW)]
    for i in range(many(20000, options.scale)):
        meshes[i % len(meshes)].add(straw(rng, times), [(0, 1, 2)])
    field = Mesh("field", scene.material("field", (0.42, 0.36, 0.20)), smooth=True)
    ground(field, 80.0, 0.0)
    for mesh in (*meshes, field):
        scene.mesh(mesh)
    return scene
