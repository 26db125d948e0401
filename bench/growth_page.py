"""Tables and plots of how costs grow with triangles, resolution, motion, key spans and sets of key times."""

import svg_plot
from numbers_of import write_estimate

RAYS = (1, 4, 16)
AXES = {"triangles": ("triangles", "triangles"), "resolution": ("size", "pixels"),
        "motion": ("pixels per shutter", "pixels of motion"), "spans": ("key spans", "key spans"), "sets": ("sets", "sets of key times")}
PARTS_OF_WORK = ("nodes", "tests", "root_solves", "segments")


def points_of(growth, axis):
    """(point, series, what the axis says) in the file's order."""
    split = [point.split("/") for point in growth.points]
    return [("/".join(parts), parts[1], parts[2]) for parts in split if parts[0] == axis]


def place(axis, value):
    """Along the plot's axis."""
    if axis == "resolution":
        width, height = value.split("x")
        return float(width) * float(height)
    return float(value)


def tables(growth, table, plain):
    """{axis: table}"""
    result = {}
    for axis, (head, _) in AXES.items():
        rows = []
        for point, series, value in points_of(growth, axis):
            count = growth.median(point, "triangles") or 1
            build = growth.median(point, "build_tc_s"), growth.median(point, "build_discrete_s")
            size = [(growth.median(point, m) or 0) / count for m in ("bytes_tc", "bytes_discrete")]
            shown = f"{round(count):,}" if axis == "triangles" else value
            rows.append([series, shown, *(plain(growth.median(point, "tc_ns", n)) for n in RAYS),
                         plain(growth.median(point, "discrete_ns", 16)),
                         *(write_estimate(growth.ratio(point, "tc_ns", "discrete_ns", n)) for n in RAYS),
                         f"{plain(build[0], 2)} / {plain(build[1], 2)}", f"{plain(size[0])} / {plain(size[1])}",
                         *(plain(growth.median(point, m, 16), 1) for m in PARTS_OF_WORK)])
        result[axis] = table(["scene", head, "tc, 1: ns", "4", "16", "discrete", "ratio, 1", "4", "16", "building, tc / Embree: s",
                              "bytes per triangle", "nodes", "triangles tested", "root solves", "segments"], rows)
    return result


def plots(growth):
    """{axis: picture}: nanoseconds per ray; whole lines for the first scene, dashed ones for the second."""
    result = {}
    for axis, (_, label) in AXES.items():
        series, names = [], list(dict.fromkeys(name for _, name, _ in points_of(growth, axis)))
        for dashed, name in zip((False, True), names):
            own = [(point, place(axis, value)) for point, s, value in points_of(growth, axis) if s == name]
            for colour, (measure, n, title) in zip(svg_plot.COLOURS, (("tc_ns", 16, "tc, 16"), ("tc_ns", 4, "tc, 4"),
                                                                      ("tc_ns", 1, "tc, 1"), ("discrete_ns", 16, "discrete"))):
                curve = [(x, growth.median(point, measure, n)) for point, x in own]
                # No motion at all has no place on a logarithmic axis; the table has it.
                curve = [(x, y) for x, y in curve if x > 0 and y]
                series.append(("" if dashed else title, colour, dashed, curve))
        every = [p for *_, curve in series for p in curve]
        if not every:
            result[axis] = "\n".join([*svg_plot.frame("nothing measured"), "</svg>", ""])
            continue
        xs, ys = sorted({x for x, _ in every}), [y for _, y in every]
        low, high = 0.8 * min(ys), 1.2 * max(ys)
        scenes = ", ".join(name + (" (dashed)" if i else "") for i, name in enumerate(names))
        result[axis] = svg_plot.lines(f"ns per ray over {label}: {scenes}", series, svg_plot.marks_of_decades(xs[0], xs[-1],
                                      (1, 2, 5) if xs[-1] / xs[0] < 1000 else (1,)), svg_plot.marks_of_decades(low, high),
                                      (xs[0], xs[-1]), (low, high), log_y=True)
    return result
