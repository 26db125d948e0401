"""Lit shapes, added to a Mesh: quads, boxes, tubes, rings. Counter-clockwise seen from outside."""

import math

from .light import lit
from .maths import add, cross, mul, sub, unit


def face(mesh, albedo, points, shadow=0.0, two_sided_light=False):
    """A convex polygon, flat. `two_sided_light`: light it as if it faced the sun (thin things)."""
    normal = unit(cross(sub(points[1], points[0]), sub(points[2], points[0])))
    color = lit(albedo, normal, shadow)
    if two_sided_light:
        color = max(color, lit(albedo, mul(normal, -1), shadow), key=lambda c: sum(c[1:]))
    for i in range(1, len(points) - 1):
        mesh.add(color, [(points[0], normal), (points[i], normal), (points[i + 1], normal)])


def plain(mesh, color, points):
    """A convex polygon in one colour, whatever the light."""
    normal = unit(cross(sub(points[1], points[0]), sub(points[2], points[0])))
    for i in range(1, len(points) - 1):
        mesh.add(color, [(points[0], normal), (points[i], normal), (points[i + 1], normal)])


def box(mesh, albedo, low, high, shadow=0.0):
    (x0, y0, z0), (x1, y1, z1) = low, high
    face(mesh, albedo, [(x1, y0, z1), (x1, y0, z0), (x1, y1, z0), (x1, y1, z1)], shadow)
    face(mesh, albedo, [(x0, y0, z0), (x0, y0, z1), (x0, y1, z1), (x0, y1, z0)], shadow)
    face(mesh, albedo, [(x0, y1, z1), (x1, y1, z1), (x1, y1, z0), (x0, y1, z0)], shadow)
    face(mesh, albedo, [(x0, y0, z0), (x1, y0, z0), (x1, y0, z1), (x0, y0, z1)], shadow)
    face(mesh, albedo, [(x0, y0, z1), (x1, y0, z1), (x1, y1, z1), (x0, y1, z1)], shadow)
    face(mesh, albedo, [(x1, y0, z0), (x0, y0, z0), (x0, y1, z0), (x1, y1, z0)], shadow)


def _frame(axis):
    """Two unit vectors at right angles to `axis` and to each other."""
    axis = unit(axis)
    side = unit(cross(axis, (0, 1, 0) if abs(axis[1]) < 0.9 else (1, 0, 0)))
    return side, cross(axis, side)


def tube(mesh, albedo, begin, end, radius, sides=8, end_radius=None, shadow=0.0):
    """A cone or cylinder without caps, its normals smooth around it."""
    end_radius = radius if end_radius is None else end_radius
    u, v = _frame(sub(end, begin))
    around = [2 * math.pi * i / sides for i in range(sides + 1)]
    normals = [unit(add(mul(u, math.cos(a)), mul(v, math.sin(a)))) for a in around]
    for i in range(sides):
        n0, n1 = normals[i], normals[(i + 1) % sides]
        a, b = add(begin, mul(n0, radius)), add(begin, mul(n1, radius))
        c, d = add(end, mul(n1, end_radius)), add(end, mul(n0, end_radius))
        color = lit(albedo, unit(add(n0, n1)), shadow)
        mesh.add(color, [(a, n0), (b, n1), (c, n1)])
        if end_radius > 0:
            mesh.add(color, [(a, n0), (c, n1), (d, n0)])


def torus(mesh, albedo, radius, thickness, segments=64, sides=6, banded=None):
    """About the z axis. `banded(i)`: the albedo of segment i instead of `albedo`."""

    def vertex(i, j):
        a, b = 2 * math.pi * (i % segments) / segments, 2 * math.pi * (j % sides) / sides
        out = (math.cos(a), math.sin(a), 0.0)
        normal = add(mul(out, math.cos(b)), (0.0, 0.0, math.sin(b)))
        return add(mul(out, radius), mul(normal, thickness)), normal

    for i in range(segments):
        for j in range(sides):
            a, b, c, d = vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)
            # Lit as seen from the camera's side: a wheel turns, the light on it does not.
            color = lit(banded(i) if banded else albedo, unit(add(add(a[1], c[1]), (0.0, 0.3, 0.6))))
            mesh.add(color, [a, b, c])
            mesh.add(color, [a, c, d])


def disc(mesh, color, center, radius, segments=32, inner=0.0):
    """A disc or a ring facing +z, in one colour."""
    for i in range(segments):
        a, b = (2 * math.pi * k / segments for k in (i, i + 1))
        p = add(center, (math.cos(a) * radius, math.sin(a) * radius, 0))
        q = add(center, (math.cos(b) * radius, math.sin(b) * radius, 0))
        r = add(center, (math.cos(b) * inner, math.sin(b) * inner, 0))
        s = add(center, (math.cos(a) * inner, math.sin(a) * inner, 0))
        plain(mesh, color, [p, q, r, s] if inner > 0 else [p, q, center])
