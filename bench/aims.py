"""What was aimed at, what version 0.1.0 measured, and what came of it."""

import math

from numbers_of import pooled, write_estimate


def least(estimates):
    """Of several, by their medians."""
    known = [e for e in estimates if e]
    return min(known, default=None)


def most(estimates):
    known = [e for e in estimates if e]
    return max(known, default=None)


def verdict(value, aim, smaller):
    """By the median."""
    if value is None:
        return "not measured"
    return "reached" if (value[0] <= aim if smaller else value[0] >= aim) else "not reached"


def between(growth, measure, point, other, rays=0):
    """One measure of two points: each of them on its own, so there is no interval."""
    above, below = growth.median(point, measure, rays), growth.median(other, measure, rays)
    return (above / below, math.nan, math.nan) if above and below else None


def rows_of(rays, renders, gains, growth):
    """(what, aim, 0.1.0, is smaller better, value); those of dB say so. 0.1.0's are those of its own pages, made with full
    effort; None where it had none."""
    ratio = lambda point, n: rays.ratio(point, "tc_ns", "discrete_ns", n)  # noqa: E731
    tc = lambda point, n: gains.gain(point, "tc", "owen-sobol", "tc_rays", n)  # noqa: E731
    auto = lambda point, b: gains.gain(point, "auto", "owen-sobol", "spp", b)  # noqa: E731
    def whole(point, n):
        return renders.ratio(point, "tc_ns", "discrete_ns", n, (renders.rays(point, "discrete_ns") or [64])[0])

    sets = lambda measure, n=0: between(growth, measure, "sets/swarm/1024", "sets/swarm/1", n)  # noqa: E731
    spans = lambda n: most([between(growth, "tc_ns", f"spans/{s}/16", f"spans/{s}/1", n)  # noqa: E731
                            for s in ("terrain", "swarm")])
    terrain = "spans/terrain/16"
    size, count = growth.median(terrain, "bytes_tc"), growth.median(terrain, "triangles")
    rows = [("1024 sets of key times over one: a time-continuous ray alone", 2, 600, True, sets("tc_ns", 1)),
            ("the same, 16 rays", 2, None, True, sets("tc_ns", 16)),
            ("the same, a discrete ray", 2, 1700, True, sets("discrete_ns", 16)),
            ("the same, bytes, time-continuous", 2, None, True, sets("bytes_tc")),
            ("the same, bytes, discrete", 2, None, True, sets("bytes_discrete")),
            ("16 key spans over one, one ray, the dearer of terrain and swarm", 2, 5.2, True, spans(1)),
            ("the same, 16 rays", 2, 2.4, True, spans(16)),
            ("bytes per triangle, terrain, 16 key spans", 700, 1888, True,
             (size / count, math.nan, math.nan) if size and count else None),
            ("cost ratio, hall, nothing moves, 16 rays", 2.5, 7.80, True, ratio("still", 16)),
            ("cost ratio, kitchen at 960x540, 4 rays", 6, 2.73, True, ratio("kitchen", 4)),
            ("cost ratio, kitchen at 960x540, 16 rays", 5, 1.90, True, ratio("kitchen", 16)),
            ("cost ratio, blades, 16 rays", 1.5, 2.96, True, ratio("blades", 16)),
            ("single incoherent ray, kitchen", 10, 3.19, True,
             rays.ratio("kitchen", "incoherent_tc_ns", "incoherent_discrete_ns", 1))]
    # With sample points, shading and film.
    for point, n, aim in (("garden-960", 4, 6), ("garden-960", 16, 4), ("crowd", 4, 5), ("crowd", 16, 4), ("blades", 16, 1.5),
                          ("foliage", 4, 3), ("foliage", 16, 2.2), ("still", 16, 2.5)):
        rows.append((f"cost ratio, whole rendering, {point}, {n} rays", aim, None, True, whole(point, n)))
    for point, n, aim, before in (("kitchen", 4, 5, 7.77), ("kitchen", 16, 7, 14.40), ("kitchen-fast", 4, 5, 9.89),
                                  ("kitchen-fast", 16, 7, 12.77), ("foliage", 4, 8, 7.32), ("foliage", 16, 8, 10.90),
                                  ("blades", 4, 8, 16.47), ("blades", 16, 8, 19.74)):
        rows.append((f"dB over Owen-Sobol', {point}, time of {n} rays", aim, before, False, tc(point, n)))
    rows += [("dB, hall with a figure, auto, time of 64 samples", 1.5, 6.51, False, auto("hall", 64)),
             ("dB, hall with a figure, auto, time of 128 samples", 2.5, 7.78, False, auto("hall", 128))]
    before = {"kitchen-slow": -0.94, "kitchen": -0.48, "kitchen-fast": -0.67, "hall": -1.15, "still": -1.42,
              "foliage": -0.35, "blades": -0.10, "wires": -0.67}
    rows += [(f"dB, auto, {point}, the least of 4 to 256 samples", -0.3, before.get(point), False,
              least([auto(point, b) for b in (4, 8, 16, 32, 64, 128, 256)])) for point in gains.points]
    rows.append(("two threads over one, rendering with tc, over all scenes", 1.9, 1.90, False,
                 pooled([renders.ratio(p, "render_tc_1_s", "render_tc_2_s", n) for p in renders.points
                         for n in renders.rays(p, "render_tc_1_s")])))
    return rows


def aims_table(rays, renders, gains, growth, table):
    rows = []
    for what, aim, before, smaller, value in rows_of(rays, renders, gains, growth):
        sign, decibels = "<=" if smaller else ">=", "dB" in what
        rows.append([what, f"{sign} {aim:g}", "-" if before is None else f"{before:+g}" if decibels else f"{before:g}",
                     write_estimate(value, 2, decibels), verdict(value, aim, smaller)])
    return table(["", "aim", "0.1.0", "measured", ""], rows)
