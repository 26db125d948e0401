"""Pebbles in the air, each of 320 triangles and with a motion of its own: their number (--scale), the length of their motion
in pixels (--motion) and its key spans (--spans) can be chosen, and over how many meshes (--meshes) with how many different sets
of key times (--sets) they are spread. They cover about the same part of the picture however
many there are. To see how costs grow.
"""

import array
import math
import random

from demo_scene.maths import add, mul, unit

from .native import Mesh, Scene, many
from .terrain import HEIGHT, VFOV, WIDTH, journey, pixel_size

NEAR, FAR = 3.0, 12.0
COVER = 2.0  # how many of them a ray meets, about, if nothing hides anything
SPLITS, COUNT = 2, 312  # 320 triangles each; so many are 100 thousand triangles


def ball(splits):
    """Points on the unit sphere and triangles: an icosahedron, each triangle cut in four, again and again."""
    golden = (1 + math.sqrt(5)) / 2
    points = [unit(p) for p in ((-1, golden, 0), (1, golden, 0), (-1, -golden, 0), (1, -golden, 0), (0, -1, golden),
                                (0, 1, golden), (0, -1, -golden), (0, 1, -golden), (golden, 0, -1), (golden, 0, 1),
                                (-golden, 0, -1), (-golden, 0, 1))]
    triangles = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2),
                 (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11),
                 (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    for _ in range(splits):
        halves, cut = {}, []

        def half(a, b):
            edge = (min(a, b), max(a, b))
            if edge not in halves:
                halves[edge] = len(points)
                points.append(unit(mul(add(points[a], points[b]), 0.5)))
            return halves[edge]

        for a, b, c in triangles:
            ab, bc, ca = half(a, b), half(b, c), half(c, a)
            cut += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        triangles = cut
    return points, triangles


def key_times(spans, number, rng):
    """Even ones, or for all sets but the first each key up to a third of a span off."""
    return [(key + (rng.uniform(-1 / 3, 1 / 3) if number and 0 < key < spans else 0)) / spans for key in range(spans + 1)]


def make(folder, options):
    rng = random.Random(312)
    scene = Scene(folder, WIDTH, HEIGHT)
    scene.camera(VFOV, ((0.0, 0.0, 0.0), (0.0, 0.0, -1.0)))
    scene.set(background=[0.55, 0.70, 0.95])
    scene.light("directional", direction=[-0.6, -0.7, -0.2], irradiance=[3.4, 3.2, 2.8])
    scene.light("constant", radiance=[0.35, 0.40, 0.50])
    points, triangles = ball(SPLITS)
    count, flat = many(COUNT, options.scale), [number for point in points for number in point]
    material, names = scene.material("pebbles", (0.62, 0.50, 0.40)), random.Random(1024)
    sets = [key_times(options.spans, i, names) for i in range(options.sets)]
    meshes = [Mesh("pebbles" if options.meshes == 1 else f"pebbles{i}", material, options.spans + 1)
              for i in range(options.meshes)]
    high = math.tan(math.radians(VFOV) / 2)
    wide = high * WIDTH / HEIGHT
    # On the picture at distance 1 each covers its share of COVER times the picture.
    radius = math.sqrt(COVER * 4 * wide * high / (math.pi * count))
    indices = array.array("i", [corner for triangle in triangles for corner in triangle])
    for i in range(count):
        depth = NEAR + (FAR - NEAR) * rng.random() ** 0.6
        center = (rng.uniform(-1.1, 1.1) * wide * depth, rng.uniform(-1.1, 1.1) * high * depth, -depth)
        size = radius * depth * rng.uniform(0.7, 1.3)
        angle, tumble = rng.uniform(0, math.tau), rng.uniform(-0.2, 0.2)
        way = options.motion * pixel_size() * depth
        mesh, times = meshes[i % len(meshes)], sets[i % len(meshes) % len(sets)]
        for time, row in zip(times, mesh.rows):
            along, aside = (number * way for number in journey(time, options.spans))
            place = (center[0] + along * math.cos(angle) - aside * math.sin(angle),
                     center[1] + along * math.sin(angle) + aside * math.cos(angle), center[2])
            stretch = size * (1 + tumble * time)
            numbers = array.array("f", bytes(4 * len(flat)))
            for axis in range(3):
                numbers[axis::3] = array.array("f", [place[axis] + (stretch if axis else size) * number
                                                     for number in flat[axis::3]])
            row.extend(numbers)
        mesh.triangles.extend(array.array("i", [mesh.count + corner for corner in indices]))
        mesh.count += len(points)
    for i, mesh in enumerate(meshes):
        scene.mesh(mesh, **({} if options.sets == 1 else {"times": sets[i % len(sets)]}))
    return scene
