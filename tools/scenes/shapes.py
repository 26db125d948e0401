"""Shapes that stand still, with normals, added to a smooth Mesh. Counter-clockwise seen from outside."""

import math

from demo_scene.maths import add, cross, mul, sub, unit


def frame(axis):
    """Two unit vectors at right angles to `axis` and to each other."""
    axis = unit(axis)
    side = unit(cross(axis, (0, 1, 0) if abs(axis[1]) < 0.9 else (1, 0, 0)))
    return side, cross(axis, side)


def flat(mesh, points):
    """A convex polygon."""
    normal = unit(cross(sub(points[1], points[0]), sub(points[2], points[0])))
    mesh.add([[(*point, *normal) for point in points]], [(0, i, i + 1) for i in range(1, len(points) - 1)])


def ground(mesh, side, height):
    flat(mesh, [(-side, height, side), (side, height, side), (side, height, -side), (-side, height, -side)])


def box(mesh, low, high):
    (x0, y0, z0), (x1, y1, z1) = low, high
    flat(mesh, [(x1, y0, z1), (x1, y0, z0), (x1, y1, z0), (x1, y1, z1)])
    flat(mesh, [(x0, y0, z0), (x0, y0, z1), (x0, y1, z1), (x0, y1, z0)])
    flat(mesh, [(x0, y1, z1), (x1, y1, z1), (x1, y1, z0), (x0, y1, z0)])
    flat(mesh, [(x0, y0, z0), (x1, y0, z0), (x1, y0, z1), (x0, y0, z1)])
    flat(mesh, [(x0, y0, z1), (x1, y0, z1), (x1, y1, z1), (x0, y1, z1)])
    flat(mesh, [(x1, y0, z0), (x0, y0, z0), (x0, y1, z0), (x1, y1, z0)])


def grid(mesh, rows, columns, vertex):
    """A surface of rows x columns quads; `vertex(u, v)` with u along the row and v across, both 0 to 1: six numbers."""
    vertices = [vertex(i / columns, j / rows) for j in range(rows + 1) for i in range(columns + 1)]
    triangles = []
    for j in range(rows):
        for i in range(columns):
            a = j * (columns + 1) + i
            b, c, d = a + 1, a + columns + 2, a + columns + 1
            triangles += [(a, b, c), (a, c, d)]
    mesh.add([vertices], triangles)


def tube(mesh, begin, end, radius, end_radius=None, sides=12, rows=1):
    """A cone or cylinder without caps."""
    end_radius = radius if end_radius is None else end_radius
    u, v = frame(sub(end, begin))
    axis = sub(end, begin)

    def vertex(around, along):
        angle = math.tau * around
        out = add(mul(u, math.cos(angle)), mul(v, math.sin(angle)))
        middle = add(begin, mul(axis, along))
        return (*add(middle, mul(out, radius + (end_radius - radius) * along)), *out)

    grid(mesh, rows, sides, vertex)


def turned(mesh, center, profile, sides=48):
    """A lathe's work about the y axis: `profile` is a list of (radius, height, normal out, normal up), bottom to top."""

    def vertex(around, along):
        radius, height, out, up = profile[round(along * (len(profile) - 1))]
        x, z = math.sin(math.tau * around), math.cos(math.tau * around)
        return (center[0] + radius * x, center[1] + height, center[2] + radius * z, out * x, up, out * z)

    grid(mesh, len(profile) - 1, sides, vertex)


def sphere(mesh, center, radius, rows=32):
    profile = []
    for i in range(rows + 1):
        angle = math.pi * (i / rows - 0.5)
        out, up = math.cos(angle), math.sin(angle)
        profile.append((radius * out, radius * up, out, up))
    turned(mesh, center, profile, 2 * rows)
