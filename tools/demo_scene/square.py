"""What stands still: sky, floor, an arcade, a tower, long shadows."""

import math

from .glb import Mesh
from .light import glowing, lit, quantise, shadow_offset
from .maths import mix
from .shapes import box, face, plain, tube

OCHRE = (0.66, 0.40, 0.16)
PLASTER = (0.78, 0.66, 0.48)
HORIZON = (0.93, 0.66, 0.30)
SKY_STOPS = [(0.0, HORIZON), (0.10, (0.72, 0.60, 0.36)), (0.28, (0.22, 0.40, 0.38)), (0.55, (0.06, 0.20, 0.27)),
             (1.0, (0.012, 0.055, 0.12))]
SHADOW = 0.86


def sky_color(height):
    """From 0 at the horizon to 1 at the top."""
    for (h0, c0), (h1, c1) in zip(SKY_STOPS, SKY_STOPS[1:]):
        if height <= h1:
            return mix(c0, c1, (height - h0) / (h1 - h0))
    return SKY_STOPS[-1][1]


def floor_color(z, shadow=0.0):
    """The floor fades into the horizon's colour with distance."""
    near = lit(OCHRE, (0, 1, 0), shadow)[1:]
    haze = min(max((-z - 4) / 60, 0), 1) ** 0.8
    return quantise("base", mix(near, (0.80, 0.55, 0.25), haze * (1 - 0.5 * shadow)))


def add_sky(mesh, bands=56):
    far, top, half_width = -75.0, 46.0, 90.0
    for i in range(bands):
        y0, y1 = top * (i / bands) ** 1.3, top * ((i + 1) / bands) ** 1.3
        color = glowing(sky_color((y0 + y1) / 2 / top))
        plain(mesh, color, [(-half_width, y0, far), (half_width, y0, far), (half_width, y1, far), (-half_width, y1, far)])


def add_floor(mesh):
    edges = [14.0]
    while edges[-1] > -75:
        edges.append(edges[-1] - 1.5 * 1.045 ** len(edges))
    for z0, z1 in zip(edges, edges[1:]):
        z1 = max(z1, -75.0)
        plain(mesh, floor_color((z0 + z1) / 2), [(-90, 0, z0), (90, 0, z0), (90, 0, z1), (-90, 0, z1)])


def add_floor_shadow(mesh, outline):
    """`outline`: (x, z) corners, convex, counter-clockwise seen from above."""
    z = sum(corner[1] for corner in outline) / len(outline)
    plain(mesh, floor_color(z, SHADOW), [(x, 0.004, z) for x, z in outline])


def add_arch(mesh, x, z, width, spring, wall_top, depth, segments=18):
    """One bay of a wall in the plane of constant x that faces +x, from z to z - width."""
    pier = 0.34
    radius, middle = width / 2 - pier, z - width / 2
    # Points of the opening's edge, from the near foot over the arch to the far foot.
    edge = [(0.0, middle + radius), (spring, middle + radius)]
    for i in range(1, segments):
        a = math.pi * i / segments
        edge.append((spring + radius * math.sin(a), middle + radius * math.cos(a)))
    edge += [(spring, middle - radius), (0.0, middle - radius)]
    face(mesh, PLASTER, [(x, 0, z), (x, 0, middle + radius), (x, wall_top, middle + radius), (x, wall_top, z)])
    face(mesh, PLASTER, [(x, 0, middle - radius), (x, 0, z - width), (x, wall_top, z - width), (x, wall_top, middle - radius)])
    for (y0, z0), (y1, z1) in zip(edge, edge[1:]):
        if z0 != z1:
            face(mesh, PLASTER, [(x, y0, z0), (x, y1, z1), (x, wall_top, z1), (x, wall_top, z0)])
        face(mesh, PLASTER, [(x, y0, z0), (x - depth, y0, z0), (x - depth, y1, z1), (x, y1, z1)], shadow=0.75)


def add_arcade(mesh):
    x, front, bays, bay, spring, top, depth = -5.0, 4.2, 11, 3.1, 2.35, 5.4, 0.75
    for i in range(bays):
        add_arch(mesh, x, front - i * bay, bay, spring, top, depth)
    back = front - bays * bay
    box(mesh, PLASTER, (x - 0.5, top, back), (x + 0.16, top + 0.28, front))
    box(mesh, PLASTER, (x - 0.02, 4.05, back), (x + 0.05, 4.17, front))
    # The walk behind the arches lies in shadow.
    face(mesh, (0.42, 0.26, 0.16), [(x - 3.2, 0, front), (x - 3.2, 0, back), (x - 3.2, top, back), (x - 3.2, top, front)], 0.8)
    plain(mesh, floor_color(-8, 0.95), [(x - 3.2, 0.004, front), (x - depth, 0.004, front), (x - depth, 0.004, back),
                                        (x - 3.2, 0.004, back)])


def add_tower(mesh, center, scale):
    cx, cy, cz = center
    tone = (0.74, 0.40, 0.26)
    y = cy
    for radius, height in ((1.9, 5.6), (1.5, 4.4), (1.1, 2.6)):
        tube(mesh, tone, (cx, y, cz), (cx, y + height * scale, cz), radius * scale, 24)
        y += height * scale
        tube(mesh, PLASTER, (cx, y - 0.3 * scale, cz), (cx, y, cz), (radius + 0.18) * scale, 24)
    tube(mesh, (0.55, 0.16, 0.10), (cx, y, cz), (cx, y + 1.5 * scale, cz), 1.25 * scale, 24, end_radius=0.0)
    return y + 1.5 * scale


def add_pole(mesh, x, z, height, radius=0.035, albedo=(0.80, 0.74, 0.62)):
    tube(mesh, albedo, (x, 0, z), (x, height, z), radius, 10)
    dx, dz = shadow_offset(height)
    add_floor_shadow(mesh, [(x - radius, z), (x + radius, z), (x + dx + radius, z + dz), (x + dx - radius, z + dz)])


def make_square():
    mesh = Mesh("square")
    add_sky(mesh)
    add_floor(mesh)
    add_arcade(mesh)
    return mesh
