"""Hills that slide and ripple: one surface whose number of triangles (--scale), length of motion in pixels (--motion) and
key spans (--spans) can be chosen while the picture stays about the same. To see how costs grow.
"""

import array
import math

from .native import Mesh, Scene, many

WIDTH, HEIGHT, VFOV = 960, 540, 40.0  # of the picture that lengths in pixels refer to
DOWN = 0.32  # how far the camera looks down, at distance 1
NEAR, FAR, FLOOR = 2.0, 9.0, -1.6  # of the hills: distances from the camera, and how far below it
OCTAVES = [(1.3, 0.30), (2.9, 0.14), (6.1, 0.06), (13.7, 0.025)]  # waves across the picture, height


def pixel_size():
    """Of a pixel, at distance 1."""
    return 2 * math.tan(math.radians(VFOV) / 2) / HEIGHT


def journey(time, spans):
    """Where, along and across its way, something is at a time from 0 to 1: once along, on an arc if there are corners."""
    return time, 0.25 * math.sin(math.pi * time) if spans > 1 else 0.0


def surface(mesh, rows, columns, options):
    """Rows away from the camera. Heights are sums of products of what depends on row and column alone: quick to make."""
    step, half = pixel_size(), WIDTH / HEIGHT * math.tan(math.radians(VFOV) / 2) * 1.3
    across = [2 * i / columns - 1 for i in range(columns + 1)]
    waves = [([height * math.sin(math.pi * waves * u + 1.7 * k) for u in across], waves, k)
             for k, (waves, height) in enumerate(OCTAVES)]
    # Things move by this much to the right, more and less from place to place.
    push = [1 + 0.25 * math.sin(9.0 * u) for u in across]
    for key, row_of_key in enumerate(mesh.rows):
        along, aside = journey(key / options.spans, options.spans)
        for j in range(rows + 1):
            depth = NEAR * (FAR / NEAR) ** (j / rows)
            # As the camera measures it: along its view.
            way = options.motion * step * (depth - FLOOR * DOWN) / math.hypot(1, DOWN)
            factors = [math.cos(waves * depth * 0.7 + k) * math.sqrt(depth) for _, waves, k in waves]
            heights = [FLOOR + aside * way] * (columns + 1)
            for (wave, _, _), factor in zip(waves, factors):
                heights = [h + w * factor for h, w in zip(heights, wave)]
            side, move = half * depth, along * way
            numbers = array.array("f", bytes(12 * (columns + 1)))
            numbers[0::3] = array.array("f", [u * side + p * move for u, p in zip(across, push)])
            numbers[1::3] = array.array("f", heights)
            numbers[2::3] = array.array("f", [-depth]) * (columns + 1)
            row_of_key.extend(numbers)
    mesh.count = (rows + 1) * (columns + 1)
    for j in range(rows):
        a = j * (columns + 1)
        b = a + columns + 1  # of the next row, farther away
        mesh.triangles.extend([corner for i in range(columns)
                               for corner in (a + i, a + i + 1, b + i + 1, a + i, b + i + 1, b + i)])


def make(folder, options):
    scene = Scene(folder, WIDTH, HEIGHT)
    scene.camera(VFOV, ((0.0, 0.0, 0.0), (0.0, -DOWN, -1.0)))
    scene.set(background=[0.55, 0.70, 0.95])
    scene.light("directional", direction=[-0.6, -0.7, -0.2], irradiance=[3.4, 3.2, 2.8])
    scene.light("constant", radiance=[0.35, 0.40, 0.50])
    side = many(100000, options.scale, 8)
    rows = max(2, round(math.sqrt(side / 2)))
    hills = Mesh("hills", scene.material("hills", (0.36, 0.44, 0.22)), options.spans + 1)
    surface(hills, rows, max(2, round(side / 2 / rows)), options)
    scene.mesh(hills)
    return scene
