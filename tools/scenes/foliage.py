"""A tree, a bush and a meadow in a storm: tens of thousands of leaves and blades of grass, each with its own motion.

At 640x360, most leaves move by 3 to 30 pixels while the shutter is open, blades of grass by up to 60.
"""

import math
import random

from demo_scene.maths import add, cross, dot, mul, rotate, turn, unit

from .native import Mesh, Scene, many
from .shapes import ground, tube

GREENS = [(0.16, 0.34, 0.05), (0.25, 0.45, 0.07), (0.36, 0.52, 0.10), (0.50, 0.55, 0.12), (0.62, 0.42, 0.09)]
GRASS = [(0.14, 0.30, 0.05), (0.24, 0.40, 0.07), (0.45, 0.48, 0.16)]
WIND = unit((1.0, 0.0, 0.25))
TRUNK = (1.35, 0.0)  # x, z
# Balls of leaves: center, radius, how many, their length.
CROWN = [((0.3, 2.35, 0.1), 0.72, 2000, 0.17), ((1.3, 2.2, 0.7), 0.75, 2300, 0.17), ((2.35, 2.3, 0.2), 0.8, 2000, 0.17),
         ((0.75, 3.1, 0.0), 0.75, 2000, 0.17), ((1.9, 3.15, 0.2), 0.8, 2000, 0.17), ((1.35, 2.65, -0.3), 0.8, 1500, 0.17)]
BUSHES = [((-2.6, 0.65, 0.9), 0.75, 2500, 0.13), ((-1.75, 0.5, 1.2), 0.55, 1500, 0.12), ((-3.3, 0.6, 0.3), 0.8, 1500, 0.13)]
HEDGE = [((-6.6 + 1.45 * i, 0.85 + 0.25 * (i * 7 % 4), -3.4 - 0.3 * (i * 5 % 3)), 1.05, 950, 0.24) for i in range(10)]


def gust(point, time):
    """How far the wind pushes what is at a place, at a time in shutters, in -1 to 1."""
    phase = 0.35 * point[0] + 0.22 * point[2] + 0.1 * point[1]
    return 0.7 * math.sin(math.tau * (0.12 * time - phase)) + 0.3 * math.sin(math.tau * (0.31 * time - 2.3 * phase))


def in_ball(rng, center, radius):
    """In the outer half of the radius, where leaves grow."""
    while True:
        offset = tuple(rng.uniform(-1, 1) for _ in range(3))
        if 0.5 < math.sqrt(dot(offset, offset)) < 1:
            return add(center, mul(offset, radius))


def leaf(rng, stem, center, length, times):
    """A rhombus folded along its middle, that flutters about its stem while its twig sways."""
    out = unit(tuple(p - c + rng.gauss(0, 0.35) for p, c in zip(stem, center)))
    along = unit(add(out, (rng.gauss(0, 0.4), rng.gauss(-0.3, 0.4), rng.gauss(0, 0.4))))
    across = unit(cross(along, (rng.gauss(0, 1), rng.gauss(0, 1), rng.gauss(0, 1))))
    above = cross(across, along)
    half = 0.33 * length
    shape = [(0.0, 0.0, 0.0), add(add(mul(along, 0.45 * length), mul(across, half)), mul(above, 0.25 * half)),
             mul(along, length), add(add(mul(along, 0.45 * length), mul(across, -half)), mul(above, 0.25 * half))]
    swing, rate, phase = rng.uniform(0.3, 0.9), rng.uniform(0.1, 0.28), rng.random()
    drift = tuple(rng.gauss(0, 0.12) for _ in range(3))
    keys = []
    for time in times:
        angle = math.degrees(swing * math.sin(math.tau * (rate * time + phase)))
        turned = turn(add(mul(along, 0.5), mul(across, 1.0)), angle)
        twist = turn(along, 1.3 * math.degrees(swing * math.sin(math.tau * (1.3 * rate * time + 2 * phase))))
        base = add(add(stem, mul(WIND, 0.32 * gust(stem, time))), mul(drift, math.sin(math.tau * (0.2 * time + phase))))
        keys.append([add(base, rotate(turned, rotate(twist, point))) for point in shape])
    return keys


def blade(rng, root, height, times):
    """A blade of grass in three parts, bent by the wind."""
    azimuth = rng.uniform(0, math.tau)
    side = (math.cos(azimuth), 0.0, math.sin(azimuth))
    lean = (rng.gauss(0, 0.25), 0.0, rng.gauss(0, 0.25))
    width, stiffness, phase = rng.uniform(0.006, 0.012), rng.uniform(0.6, 1.3), rng.uniform(-0.12, 0.12)
    keys = []
    for time in times:
        push = add(lean, mul(WIND, 0.35 + stiffness * gust(root, time + phase / 0.12)))
        points = []
        for share in (0.0, 0.45, 0.8, 1.0):
            bend = mul(push, share * share * height)
            middle = add(add(root, bend), (0.0, height * share * (1 - 0.25 * share * share), 0.0))
            half = width * (1 - 0.6 * share)
            points += [add(middle, mul(side, -half)), add(middle, mul(side, half))] if share < 1 else [middle]
        keys.append(points)
    return keys


BLADE = [(0, 1, 3), (0, 3, 2), (2, 3, 5), (2, 5, 4), (4, 5, 6)]
LEAF = [(0, 1, 2), (0, 2, 3)]


def branches(mesh, rng):
    x, z = TRUNK
    tube(mesh, (x + 0.05, -0.05, z), (x, 1.6, z), 0.13, 0.08)
    for center, radius, _, _ in CROWN:
        tube(mesh, (x, rng.uniform(1.2, 1.58), z), center, 0.05, 0.02)
        for _ in range(4):
            tube(mesh, center, in_ball(rng, center, radius), 0.02, 0.006)
    for center, radius, _, _ in BUSHES + HEDGE:
        for _ in range(5):
            tube(mesh, (center[0], 0.0, center[2]), in_ball(rng, center, radius), 0.02, 0.006)


def make(folder, options):
    rng = random.Random(2017)
    scene = Scene(folder, 640, 360)
    scene.camera(36, ((0.0, 1.0, 6.8), (-0.05, 1.8, 0.0)))
    scene.set(background=[0.50, 0.66, 0.85])
    scene.light("directional", direction=[-0.55, -0.75, -0.45], irradiance=[2.6, 2.4, 2.0])
    scene.light("constant", radiance=[0.30, 0.38, 0.48])

    spans = options.spans
    times = [key / spans for key in range(spans + 1)]
    leaves = [Mesh(f"leaves{i}", scene.material(f"leaf{i}", color), spans + 1) for i, color in enumerate(GREENS)]
    for center, radius, count, length in CROWN + BUSHES + HEDGE:
        for _ in range(many(count, options.scale)):
            stem = in_ball(rng, center, radius)
            tone = min(len(GREENS) - 1, int(len(GREENS) * rng.random() ** 1.6))
            leaves[tone].add(leaf(rng, stem, center, length * rng.uniform(0.6, 1.2), times), LEAF)
    grass = [Mesh(f"grass{i}", scene.material(f"grass{i}", color), spans + 1) for i, color in enumerate(GRASS)]
    for _ in range(many(14000, options.scale)):
        far = rng.random() ** 0.6  # 0 next to the camera, 1 at the back
        depth = 5.3 - 9.0 * far
        root = (rng.uniform(-1, 1) * (1.3 + 0.62 * (5.6 - depth)), 0.0, depth)
        grass[rng.randrange(3)].add(blade(rng, root, rng.uniform(0.22, 0.5), times), BLADE)
    wood = Mesh("wood", scene.material("wood", (0.20, 0.13, 0.08)), smooth=True)
    branches(wood, rng)
    earth = Mesh("earth", scene.material("earth", (0.22, 0.24, 0.10)), smooth=True)
    ground(earth, 60.0, 0.0)
    for mesh in (*leaves, *grass, wood, earth):
        scene.mesh(mesh)
    return scene
