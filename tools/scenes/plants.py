"""Plants that stand still, around the origin, in metres; and where to put copies of them."""

import math

from demo_scene.maths import add, cross, mul, unit

from .shapes import tube


def placed(x, y, z, size, turn, lean=(0.0, 0.0)):
    """A matrix, column after column: turned about the y axis, then sheared by `lean` per metre of height, as the wind
    does it."""
    c, s = math.cos(turn) * size, math.sin(turn) * size
    return (c, 0.0, -s, 0.0, lean[0] * size, size, lean[1] * size, 0.0, s, 0.0, c, 0.0, x, y, z, 1.0)


def leaf(mesh, stem, along, length, width, rng):
    """Two triangles, folded along the middle; where the mesh is pictured, a card as wide as the picture."""
    across = unit(cross(along, (rng.gauss(0, 1), rng.gauss(0, 1), rng.gauss(0, 1))))
    above = cross(across, along)
    tip = add(stem, mul(along, length))
    if mesh.pictured:
        half = mul(across, width)
        mesh.add([[(*add(stem, mul(half, -1)), 0, 0), (*add(stem, half), 1, 0), (*add(tip, half), 1, 1),
                   (*add(tip, mul(half, -1)), 0, 1)]], [(0, 1, 2), (0, 2, 3)])
        return
    middle = add(add(stem, mul(along, 0.45 * length)), mul(above, 0.15 * width))
    mesh.add([[stem, add(middle, mul(across, width)), tip, add(middle, mul(across, -width))]], [(0, 1, 2), (0, 2, 3)])


def tuft(mesh, rng, blades, height):
    """Grass: blades of three triangles."""
    for _ in range(blades):
        around, out = rng.uniform(0, math.tau), rng.uniform(0.0, 0.12)
        root = (out * math.cos(around), 0.0, out * math.sin(around))
        side, lean = (-math.sin(around) * 0.006, 0.0, math.cos(around) * 0.006), rng.uniform(0.1, 0.6)
        size = height * rng.uniform(0.6, 1.0)
        at = [add(root, (lean * size * share * share * math.cos(around), size * share,
                         lean * size * share * share * math.sin(around))) for share in (0.0, 0.55, 1.0)]
        mesh.add([[add(at[0], mul(side, -1)), add(at[0], side), add(at[1], mul(side, -0.7)), add(at[1], mul(side, 0.7)),
                   at[2]]], [(0, 1, 3), (0, 3, 2), (2, 3, 4)])


def shrub(mesh, rng, leaves, radius, length):
    """A ball of leaves on the ground."""
    for _ in range(leaves):
        out = unit((rng.gauss(0, 1), abs(rng.gauss(0, 1)) - 0.15, rng.gauss(0, 1)))
        stem = add(mul(out, radius * rng.uniform(0.4, 1.0) ** 0.5), (0.0, 0.3 * radius, 0.0))
        along = unit(add(out, (rng.gauss(0, 0.6), rng.gauss(-0.1, 0.6), rng.gauss(0, 0.6))))
        leaf(mesh, stem, along, length * rng.uniform(0.6, 1.2), 0.3 * length, rng)


def crown(mesh, rng, leaves, height, radius, length):
    """The leaves of a tree: a few balls of them around the top of its trunk."""
    balls = [(rng.gauss(0, 0.35) * radius, height + rng.gauss(0, 0.3) * radius, rng.gauss(0, 0.35) * radius)
             for _ in range(9)]
    for _ in range(leaves):
        out = unit((rng.gauss(0, 1), rng.gauss(0, 1), rng.gauss(0, 1)))
        stem = add(rng.choice(balls), mul(out, 0.6 * radius * rng.uniform(0.2, 1.0) ** 0.4))
        along = unit(add(out, (rng.gauss(0, 0.5), rng.gauss(-0.4, 0.5), rng.gauss(0, 0.5))))
        leaf(mesh, stem, along, length * rng.uniform(0.6, 1.2), 0.3 * length, rng)


def trunk(mesh, rng, height, radius, boughs):
    tube(mesh, (0, 0, 0), (0, height, 0), 0.05 * height, 0.02 * height, sides=10, rows=6)
    for _ in range(boughs):
        around, up = rng.uniform(0, math.tau), rng.uniform(0.5, 1.0) * height
        end = (0.8 * radius * math.cos(around), up + 0.5 * radius, 0.8 * radius * math.sin(around))
        tube(mesh, (0, up, 0), end, 0.015 * height, 0.004 * height, sides=6, rows=3)


def leaf_picture(size=64):
    """Opacity of a leaf: a pointed oval with a notched rim, from the top row down."""
    rows = []
    for row in range(size):
        along = 1 - (row + 0.5) / size
        half = 0.95 * math.sin(math.pi * along ** 0.8) * (0.85 + 0.15 * math.cos(9 * math.tau * along))
        rows.append([255 if abs(2 * (column + 0.5) / size - 1) < half else 0 for column in range(size)])
    return rows
