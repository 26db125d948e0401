"""What was aimed at, and what came of it."""

from numbers_of import pooled, write_estimate


def least(estimates):
    """Of several, by their medians."""
    known = [e for e in estimates if e]
    return min(known, default=None)


def verdict(value, aim, moonshot, smaller):
    """By the median."""
    if value is None:
        return "not measured"
    reaches = [value[0] <= goal if smaller else value[0] >= goal for goal in (aim, moonshot)]
    # A moonshot of "below one" is not reached by exactly one; medians never are.
    return "moonshot" if reaches[1] else "reached" if reaches[0] else "not reached"


def rows_of(rays, renders, gains):
    """(what, aim, moonshot, is smaller better, value); those of dB say so."""
    ratio = lambda point, n: rays.ratio(point, "tc_ns", "discrete_ns", n)  # noqa: E731
    tc = lambda point, n: gains.gain(point, "tc", "owen-sobol", "tc_rays", n)  # noqa: E731
    auto = lambda point, b: gains.gain(point, "auto", "owen-sobol", "spp", b)  # noqa: E731
    kitchens = ("kitchen", "kitchen-fast")
    rows = [("cost ratio, kitchen at 960x540, 4 rays", 6, 4, True, ratio("kitchen", 4)),
            ("cost ratio, kitchen at 960x540, 16 rays", 5, 3, True, ratio("kitchen", 16)),
            ("cost ratio, blades, 16 rays", 1.5, 1, True, ratio("blades", 16)),
            ("single incoherent ray, kitchen", 10, 7, True,
             rays.ratio("kitchen", "incoherent_tc_ns", "incoherent_discrete_ns", 1))]
    for point in kitchens:
        rows += [(f"dB over Owen-Sobol', {point}, time of 4 rays", 5, 8, False, tc(point, 4)),
                 (f"dB over Owen-Sobol', {point}, time of 16 rays", 7, 10, False, tc(point, 16))]
    for point in ("foliage", "blades"):
        rows += [(f"dB over Owen-Sobol', {point}, time of {n} rays", 8, 15, False, tc(point, n)) for n in (4, 16)]
    rows += [("dB, hall with a figure, auto, time of 64 samples", 1.5, 4, False, auto("hall", 64)),
             ("dB, hall with a figure, auto, time of 128 samples", 2.5, 6, False, auto("hall", 128))]
    rows += [(f"dB, auto, {point}, the least of 4 to 256 samples", -0.3, 0, False,
              least([auto(point, b) for b in (4, 8, 16, 32, 64, 128, 256)])) for point in gains.points]
    rows.append(("two threads over one, rendering with tc, over all scenes", 1.9, 2, False,
                 pooled([renders.ratio(p, "render_tc_1_s", "render_tc_2_s", n) for p in renders.points
                         for n in renders.rays(p, "render_tc_1_s")])))
    return rows


def aims_table(rays, renders, gains, table):
    rows = []
    for what, aim, moonshot, smaller, value in rows_of(rays, renders, gains):
        sign = "<=" if smaller else ">="
        rows.append([what, f"{sign} {aim:g}", f"{moonshot:g}", write_estimate(value, 2, "dB" in what),
                     verdict(value, aim, moonshot, smaller)])
    return table(["", "aim", "moonshot", "measured", ""], rows)
