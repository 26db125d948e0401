#!/usr/bin/env python3
"""When rays are inside of moving boxes that change size: in rational arithmetic.

usage: moving_boxes.py FILE SEED [CASES]

Writes a JSON object a line: "origin" and "direction" of a ray, the box "lower0" to "upper0" at time 0 and "lower1" to
"upper1" at time 1 (its faces move on straight lines in between), and the first and last time, "begin" and "end", at which
the ray, from its origin on, meets the box; null where it never does. "ill" are misses by less than a millionth.

The ray is inside of the box where six inequalities hold that are linear in dist and time together: a convex polygon of the
(dist, time) plane, whose lowest and highest time are the answer.
"""
import json
import random
import sys
from fractions import Fraction

from exact import add, between, on_grid, scale, subtract

FARTHEST = Fraction(10**6)
KINDS = ("rigid", "scaling", "flat", "along_an_axis", "from_inside", "behind", "still", "fast", "from_a_point")


def clip(polygon, a, b, c):
    """What of a convex polygon has a dist + b time + c >= 0."""
    height = lambda p: a * p[0] + b * p[1] + c
    kept = []
    for p, q in zip(polygon, polygon[1:] + polygon[:1]):
        above, next_above = height(p), height(q)
        if above >= 0:
            kept.append(p)
        if above * next_above < 0:
            kept.append(between(p, q, above / (above - next_above)))
    return kept


def interval(origin, direction, lower, upper, margin=0):
    """(first, last) or None. lower and upper are pairs: at times 0 and 1."""
    polygon = [(Fraction(0), Fraction(0)), (FARTHEST, Fraction(0)), (FARTHEST, Fraction(1)), (Fraction(0), Fraction(1))]
    for axis in range(3):
        o, d = origin[axis], direction[axis]
        low, high = (lower[0][axis], lower[1][axis]), (upper[0][axis], upper[1][axis])
        polygon = clip(polygon, d, low[0] - low[1], o - low[0] + margin)
        polygon = clip(polygon, -d, high[1] - high[0], high[0] - o + margin)
    times = [time for _, time in polygon]
    return (min(times), max(times)) if times else None


def random_case(kind, rng):
    vector = lambda size: tuple(on_grid(rng.uniform(-size, size)) for _ in range(3))
    half_size = lambda: tuple(on_grid(rng.uniform(0.05, 1.5)) for _ in range(3))
    origin, direction, centres, half_sizes = vector(4), vector(1), [vector(3), vector(3)], [half_size()] * 2
    axis = rng.randrange(3)
    if kind in ("scaling", "fast", "behind", "from_inside"):
        half_sizes[1] = half_size()
    if kind == "flat":
        half_sizes = [tuple(Fraction(0) if i == axis else x for i, x in enumerate(half_sizes[0]))] * 2
    elif kind == "along_an_axis":
        direction = tuple(Fraction(rng.choice((-1, 1)) if i == axis else 0) for i in range(3))
        if rng.random() < 0.7:
            near = add(centres[0], vector(0.5))
            origin = tuple(origin[i] if i == axis else near[i] for i in range(3))
    elif kind == "from_inside":
        centres[0] = add(origin, vector(0.05))
    elif kind == "behind":
        centres[0] = subtract(origin, scale(direction, 4))
        centres[1] = add(centres[0], vector(2))
    elif kind == "still":
        centres[1] = centres[0]
    elif kind == "fast":
        centres = [scale(centres[0], -8), scale(centres[1], 8)]
    elif kind == "from_a_point":
        half_sizes[0] = (Fraction(0),) * 3
    if kind not in ("along_an_axis", "behind") and rng.random() < 0.6:  # aimed at where the box passes
        target = add(between(*centres, on_grid(rng.random())), vector(0.5))
        direction = tuple(on_grid(x) for x in subtract(target, origin))
    if not any(direction):
        direction = (Fraction(0), Fraction(0), Fraction(1))
    lower = [subtract(centre, half) for centre, half in zip(centres, half_sizes)]
    upper = [add(centre, half) for centre, half in zip(centres, half_sizes)]
    return origin, direction, lower, upper


def main():
    file, seed = sys.argv[1], int(sys.argv[2])
    rng = random.Random(f"boxes {seed}")
    floats = lambda vector: [float(x) for x in vector]
    with open(file, "w", encoding="ascii") as out:
        for i in range(int(sys.argv[3]) if len(sys.argv) > 3 else 2000):
            origin, direction, lower, upper = case = random_case(KINDS[i % len(KINDS)], rng)
            met = interval(*case)
            begin, end = map(float, met) if met else (None, None)
            out.write(json.dumps({
                "kind": KINDS[i % len(KINDS)], "origin": floats(origin), "direction": floats(direction),
                "lower0": floats(lower[0]), "upper0": floats(upper[0]), "lower1": floats(lower[1]), "upper1": floats(upper[1]),
                "begin": begin, "end": end, "ill": met is None and interval(*case, Fraction(1, 10**6)) is not None}) + "\n")


if __name__ == "__main__":
    main()
