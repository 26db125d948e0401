#!/usr/bin/env python3
"""What rays meet and see of moving triangles, and when: in rational arithmetic, but for square roots (60 digits).

usage: moving_triangles.py FOLDER SEED [--triangles N] [--rays N]

Writes, for each kind of motion, FOLDER/KIND/: open.obj and close.obj (vertices at times 0 and 1, which move on straight
lines), scene.json, rays.txt (origin and direction a line) and hits.jsonl, a line a ray:

  hits     every stretch of time in which the ray meets a triangle, whatever lies in front of it: triangle "prim", from
           "begin" to "end", at "dist_begin" to "dist_end" in units of the direction's length, "front" where the normal
           (p1 - p0) x (p2 - p0) faces the ray's origin
  visible  the nearest triangle in the middle of each of 256 equal steps of time, or -1
  ill      a change smaller than MARGIN lies in the answer, so that floats may rightly give one of another structure

All coordinates are numbers that floats hold, so what reads the files has the same ones as this program.

The ray o + s d meets the plane of the moving triangle a(t), b(t), c(t) (relative to o) inside of it where
d . (b x c), d . (c x a) and d . (a x b) have one sign. Each is a quadratic in t: between all of their roots nothing
changes, and one look in the middle says what is the case.
"""
import argparse
import json
import pathlib
import random
from fractions import Fraction

from exact import add, between, cross, dot, on_grid, scale, square_root, subtract, vector_on_grid

MARGIN = Fraction(1, 20000)  # of the shutter
STEPS = 256


def triple_product(direction, p, q):
    """Coefficients of direction . (p(t) x q(t)), lowest first; p and q are pairs: at times 0 and 1."""
    p_motion, q_motion = subtract(p[1], p[0]), subtract(q[1], q[0])
    return (dot(direction, cross(p[0], q[0])), dot(direction, add(cross(p[0], q_motion), cross(p_motion, q[0]))),
            dot(direction, cross(p_motion, q_motion)))


def value(quadratic, time):
    c0, c1, c2 = quadratic
    return c0 + time * (c1 + time * c2)


def inner_roots(quadratic):
    """Roots strictly between 0 and 1; and whether there are two within MARGIN, or none but only just."""
    c0, c1, c2 = quadratic
    if c2 == 0:
        roots = [-c0 / c1] if c1 != 0 else []
        return [r for r in roots if 0 < r < 1], False
    discriminant = c1 * c1 - 4 * c2 * c0
    if discriminant < 0:
        extremum = -c1 / (2 * c2)
        touches = abs(value(quadratic, extremum)) < (abs(c0) + abs(c1) + abs(c2)) / 10**7
        return [], 0 < extremum < 1 and touches
    root = square_root(discriminant)
    roots = [(-c1 - root) / (2 * c2), (-c1 + root) / (2 * c2)]
    inside = [r for r in roots if 0 < r < 1]
    return inside, bool(inside) and abs(roots[1] - roots[0]) < MARGIN


class RayAndTriangle:
    def __init__(self, origin, direction, triangle):
        self.vertices = [(subtract(p, origin), subtract(q, origin)) for p, q in zip(*triangle)]
        a, b, c = self.vertices
        self.edges = [triple_product(direction, b, c), triple_product(direction, c, a), triple_product(direction, a, b)]

    def side(self, time):
        """0: the line of the ray passes the triangle by; else the sign that the three products share."""
        values = [value(edge, time) for edge in self.edges]
        if min(values) >= 0 and max(values) > 0:
            return 1
        return -1 if max(values) <= 0 and min(values) < 0 else 0

    def dist(self, time):
        """None where the line lies in the triangle's plane."""
        total = sum(value(edge, time) for edge in self.edges)
        if total == 0:
            return None
        a, b, c = (between(*vertex, time) for vertex in self.vertices)
        return dot(a, cross(b, c)) / total

    def dist_at_end(self, time, other_end):
        """The limit from inside, where the plane is seen edge on there."""
        dist = self.dist(time)
        return self.dist(time + (other_end - time) / 10**12) if dist is None else dist

    def hits(self):
        """[(begin, end, side, dist at begin, dist at end)], and whether floats may see it otherwise."""
        times, ill = {Fraction(0), Fraction(1)}, False
        for edge in self.edges:
            roots, close = inner_roots(edge)
            times.update(roots)
            ill = ill or close
        times = sorted(times)
        stretches = []
        for begin, end in zip(times, times[1:]):
            side = self.side((begin + end) / 2)
            if side != 0 and stretches and stretches[-1][1:] == [begin, side]:
                stretches[-1][1] = end
            elif side != 0:
                stretches.append([begin, end, side])
        hits = []
        for begin, end, side in stretches:
            dists = self.dist_at_end(begin, end), self.dist_at_end(end, begin)
            if max(dists) <= 0:
                continue  # behind the origin
            # Where a hit begins at the origin rather than at an edge, times are not among the roots above.
            ill = ill or min(dists) <= 0 or min(dists) < Fraction(1, 1000)
            hits.append((begin, end, side, *dists))
        ill = ill or any(end - begin < MARGIN for begin, end, *_ in hits)
        ill = ill or any(after[0] - before[1] < MARGIN for before, after in zip(hits, hits[1:]))
        ill = ill or any(not MARGIN <= time <= 1 - MARGIN for time in times[1:-1])
        return hits, ill


def triangle_of(kind, rng):
    """Three vertices at time 0 and at time 1."""
    vector = lambda *sizes: tuple(rng.uniform(-size, size) for size in sizes)
    size, centre = rng.uniform(0.3, 1.5), (*vector(2, 2), rng.uniform(-12, -4))
    first = [add(centre, vector(size, size, size)) for _ in range(3)]
    common = vector(2, 2, 1)
    if kind == "translation":
        moves = [common] * 3
    elif kind == "deform":
        moves = [add(common, vector(size, size, size)) for _ in range(3)]
    elif kind == "violent":
        moves = [vector(4, 4, 4) for _ in range(3)]
    elif kind == "slow":
        common = vector(0.02, 0.02, 0.02)
        moves = [add(common, vector(0.01, 0.01, 0.01)) for _ in range(3)]
    elif kind == "still":
        moves = [(0, 0, 0)] * 3
    elif kind == "sliver":
        edge = vector(2, 2, 0.5)
        first[1] = add(first[0], edge)
        first[2] = add(first[0], add(scale(edge, 0.5), vector(0.02, 0.02, 0.02)))
        moves = [common] * 3
    elif kind == "turn":  # its front becomes its back while it is seen: vertices change places, or pass the centre
        if rng.random() < 0.5:
            moves = [add(subtract(first[(i + 1) % 3], first[i]), vector(0.2, 0.2, 0.2)) for i in range(3)]
        else:
            moves = [scale(subtract(centre, vertex), 2) for vertex in first]
            moves[0] = add(moves[0], (0.4, 0.4, 0.4))
    elif kind == "past_the_origin":
        first = [add(vertex, (0, 0, 8)) for vertex in first]
        moves = [vector(2, 2, 6)] * 3
    first = [vector_on_grid(vertex) for vertex in first]
    return first, [vector_on_grid(add(vertex, move)) for vertex, move in zip(first, moves)]


KINDS = ("translation", "deform", "violent", "slow", "still", "sliver", "turn", "past_the_origin")


def random_ray(rng):
    vector = lambda *sizes: tuple(on_grid(rng.uniform(-size, size)) for size in sizes)
    origin = vector(0.5, 0.5, 0.5)
    if rng.random() < 0.2:
        direction = vector(1, 1, 1)
        if any(direction):
            return origin, direction
    return origin, (*vector(0.35, 0.35), Fraction(-1))


def answer(origin, direction, triangles):
    tests = [RayAndTriangle(origin, direction, triangle) for triangle in triangles]
    hits, met, ill = [], [], False
    for prim, test in enumerate(tests):
        found, is_ill = test.hits()
        ill = ill or is_ill
        if found:
            met.append(prim)
        for begin, end, side, dist_begin, dist_end in found:
            hits.append({"prim": prim, "begin": float(begin), "end": float(end), "dist_begin": float(dist_begin),
                         "dist_end": float(dist_end), "front": side < 0})
    visible = []
    for step in range(STEPS):
        time = Fraction(2 * step + 1, 2 * STEPS)
        dists = [(tests[prim].dist(time), prim) for prim in met if tests[prim].side(time) != 0]
        visible.append(min(((dist, prim) for dist, prim in dists if dist is not None and dist > 0), default=(0, -1))[1])
    return {"ill": ill, "hits": hits, "visible": visible}


def write_key(path, triangles):
    lines = ["v {!r} {!r} {!r}".format(*map(float, vertex)) for triangle in triangles for vertex in triangle]
    lines += [f"f {first} {first + 1} {first + 2}" for first in range(1, 3 * len(triangles), 3)]
    path.write_text("\n".join(lines) + "\n")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("seed", type=int)
    parser.add_argument("--triangles", type=int, default=40)
    parser.add_argument("--rays", type=int, default=60)
    arguments = parser.parse_args()
    for kind in KINDS:
        rng = random.Random(f"{kind} {arguments.seed}")
        triangles = [triangle_of(kind, rng) for _ in range(arguments.triangles)]
        rays = [random_ray(rng) for _ in range(arguments.rays)]
        folder = arguments.folder / kind
        folder.mkdir(parents=True, exist_ok=True)
        for key, name in enumerate(("open.obj", "close.obj")):
            write_key(folder / name, [triangle[key] for triangle in triangles])
        (folder / "scene.json").write_text(
            json.dumps({"kairos": 1, "meshes": [{"name": kind, "keys": ["open.obj", "close.obj"]}]}))
        (folder / "rays.txt").write_text(
            "".join(" ".join(repr(float(x)) for x in origin + direction) + "\n" for origin, direction in rays))
        (folder / "hits.jsonl").write_text("".join(json.dumps(answer(*ray, triangles)) + "\n" for ray in rays))


if __name__ == "__main__":
    main()
