#!/usr/bin/env python3
"""From DOCS/results/*.csv to the tables of DOCS/results.md and DOCS/pictures/results_*.svg.

    bench/page.py DOCS [--check]

What stands between `<!-- NAME -->` and `<!-- end NAME -->` is written anew. --check: says what differs, and writes nothing.
"""

import pathlib
import re
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "tools"))

import auto_table  # noqa: E402
import growth_page  # noqa: E402
import svg_plot  # noqa: E402
from aims import aims_table  # noqa: E402
from jobs import read_rows  # noqa: E402
from numbers_of import Gains, Numbers, write_estimate  # noqa: E402
from plan import SHOTS, TITLES  # noqa: E402

RAYS = (1, 4, 16)
COLOURS = dict(zip(RAYS, svg_plot.COLOURS))
BUDGETS = (4, 8, 16, 32, 64, 128, 256)


def table(heads, rows):
    lines = ["| " + " | ".join(heads) + " |", "| --- |" + " --- |" * (len(heads) - 1)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def plain(value, digits=0):
    return "-" if value is None else f"{value:.{digits}f}"


def titled(points):
    return [(shot.name, TITLES[shot.name]) for shot in SHOTS if shot.name in points]


def machine_text(folder):
    path = folder / "machine.csv"
    if not path.exists():
        return "Nothing has been measured."
    machine = read_rows(path)[0]
    note = "" if machine["effort"] == "full" else f" Effort: `--{machine['effort']}`, with wide intervals and fewer points."
    return f"Measured on {machine['processor']}, {machine['cores']} processors, at commit {machine['commit']}.{note}"


def ratios(rays):
    rows = []
    for point, title in titled(rays.points):
        keys = rays.median(point, "best_keys")
        rows.append([title, *(write_estimate(rays.ratio(point, "tc_ns", "discrete_ns", n)) for n in RAYS),
                     write_estimate(rays.ratio(point, "incoherent_tc_ns", "incoherent_discrete_ns", 1)),
                     "own" if keys == 0 else plain(keys)])
    return table(["scene", "1 ray", "4 rays", "16 rays", "single incoherent ray", "keys of the discrete ray"], rows)


def times(rays):
    rows = [[title, *(plain(rays.median(point, "tc_ns", n)) for n in RAYS), plain(rays.median(point, "discrete_ns", 16)),
             plain(rays.median(point, "incoherent_tc_ns", 1)), plain(rays.median(point, "incoherent_discrete_ns", 1))]
            for point, title in titled(rays.points)]
    return table(["scene; ns per ray", "tc, 1", "4", "16", "discrete", "tc, incoherent", "discrete, incoherent"], rows)


def included(renders):
    rows = []
    for point, title in titled(renders.points):
        spp = (renders.rays(point, "discrete_ns") or [64])[0]
        rows.append([title, *(write_estimate(renders.ratio(point, "tc_ns", "discrete_ns", n, spp)) for n in RAYS)])
    return table(["scene", "1 ray", "4 rays", "16 rays"], rows)


def parts(renders):
    """Nanoseconds of a ray: sample point and ray; tracing; shading and adding up."""
    rows = []
    for point, title in titled(renders.points):
        for kind, label in (("tc", "tc"), ("discrete", "discrete")):
            counts = renders.rays(point, f"{kind}_ns")
            if not counts:
                continue
            whole, traced, made = (renders.median(point, f"{kind}_{part}", counts[-1])
                                   for part in ("ns", "trace_ns", "rays_ns"))
            rows.append([f"{title}: {label}, {counts[-1]} rays", plain(made), plain(traced - made), plain(whole - traced),
                         plain(whole)])
    return table(["ns per ray", "sample point and ray", "tracing", "shading and film", "all"], rows)


def work(rays):
    rows = [[title, str(n), plain(rays.median(point, "packet", n)),
             *(plain(rays.median(point, measure, n), 1) for measure in ("nodes", "tests", "root_solves", "hits", "segments"))]
            for point, title in titled(rays.points) for n in RAYS]
    return table(["scene", "rays per pixel", "in packets of", "nodes", "triangles tested", "root solves", "hits in the list",
                  "segments"], rows)


def builds(rays):
    rows = []
    for point, title in titled(rays.points):
        if title.startswith("the same"):
            continue
        count = rays.median(point, "triangles")
        size = [(rays.median(point, m) or 0) / count for m in ("bytes_tc", "bytes_discrete", "bytes_discrete_best")]
        rows.append([title, f"{count / 1000:.0f} k", plain(rays.median(point, "build_tc_s"), 2),
                     plain(rays.median(point, "build_discrete_s"), 2),
                     write_estimate(rays.ratio(point, "build_tc_s", "build_discrete_s")), plain(size[0]), plain(size[1]),
                     plain(size[2])])
    return table(["scene", "triangles", "tc, s", "Embree, s", "ratio", "tc, bytes per triangle", "Embree", "Embree, fastest keys"],
                 rows)


def threads(renders):
    rows = [[title, *(write_estimate(renders.ratio(point, f"{what}_1_s", f"{what}_2_s", rays))
                      for what in ("render_tc", "render_discrete", "build_tc", "build_discrete")
                      for rays in (renders.rays(point, f"{what}_1_s") or [0])[:1])]
            for point, title in titled(renders.points)]
    return table(["scene", "rendering, tc", "rendering, discrete", "building, tc", "building, Embree"], rows)


def equal(gains):
    rows = []
    for point, title in titled(gains.points):
        cells = []
        for series in ("tc", "auto"):
            for baseline in ("owen-sobol", "multi-jitter"):
                for n in (4, 16):
                    star = " *" if series == "tc" and gains.near_reference(point, "tc", n) else ""
                    cells.append(write_estimate(gains.gain(point, series, baseline, "tc_rays", n), 1, True) + star)
        rows.append([title, *cells])
    heads = [f"{series} over {label}, {n}" for series in ("tc", "auto") for label in ("Owen-Sobol'", "multi-jittered")
             for n in (4, 16)]
    return table(["scene", *heads], rows)


def budgets(gains):
    rows = [[title, *(write_estimate(gains.gain(point, "auto", "owen-sobol", "spp", b), 1, True) for b in BUDGETS)]
            for point, title in titled(gains.points)]
    return table(["scene", *map(str, BUDGETS)], rows)


def ratio_plot(rays):
    points = [shot.name for shot in SHOTS if shot.name in rays.points]
    series = [(f"{n} ray{'s' if n > 1 else ''}", COLOURS[n], [rays.ratio(p, "tc_ns", "discrete_ns", n) for p in points])
              for n in RAYS]
    top = max([v[0] for _, _, values in series for v in values if v], default=1) * 1.1
    return svg_plot.intervals("cost of a time-continuous ray over a discrete one", points, series, svg_plot.even_marks(0, top),
                              (0, top))


def gain_plot(gains):
    points = [shot.name for shot in SHOTS if shot.name in gains.points]
    series = [(f"{s} at {n} rays", colour, [gains.gain(p, s, "owen-sobol", "tc_rays", n) for p in points])
              for (s, n), colour in zip((("tc", 4), ("tc", 16), ("auto", 4), ("auto", 16)), svg_plot.COLOURS)]
    known = [v[0] for _, _, values in series for v in values if v] or [0]
    low, high = min(0, *known) - 1, max(0, *known) + 1
    return svg_plot.intervals("dB over Owen-Sobol' discrete rays at the time of 4 and 16 time-continuous rays", points, series,
                              svg_plot.even_marks(low, high), (low, high))


def lit(rows):
    """What bench/light.py has measured: a row for each scene."""
    if not rows:
        return "Nothing has been measured."
    first, cells = rows[0], {}
    for row in rows:
        text = f"{float(row['db']):.1f} in {float(row['seconds']):.2f}"
        gain = "" if row["method"] == "discrete" else f" ({float(row['gain']):+.1f})"
        cells.setdefault(row["scene"], {}).setdefault(row["method"], []).append(text + gain)
    methods = [m for m in ("discrete", "auto", "mixed", "tc") if any(m in of for of in cells.values())]
    budgets = ", ".join(dict.fromkeys(row["budget"] for row in rows))
    head = (f"{first['size']}, `--shading {first['shading']}`, budgets of {budgets} samples, seeds: {first['seeds']}, against 2 x {first['reference']} discrete samples whose noise is taken off, "
            f"commit {', '.join(dict.fromkeys(row['commit'] for row in rows))}.")
    return head + "\n\n" + table(["scene", *methods], [[scene, *("; ".join(of.get(m, [])) for m in methods)] for scene, of in cells.items()])


def contents(docs):
    """(name: text) of the page's blocks and (name: text) of the pictures."""
    folder = docs / "results"
    rays, renders, growth = (Numbers(folder / f"{name}.csv") for name in ("rays", "renders", "growth"))
    gains = Gains(folder)
    blocks = {"machine": machine_text(folder), "ratios": ratios(rays), "times": times(rays), "included": included(renders),
              "parts": parts(renders), "work": work(rays), "builds": builds(rays), "threads": threads(renders),
              "equal": equal(gains), "budgets": budgets(gains),
              "auto": auto_table.summary(read_rows(folder / "auto.csv") if (folder / "auto.csv").exists() else [], table),
              "lit": lit(read_rows(folder / "light.csv") if (folder / "light.csv").exists() else []),
              "aims": aims_table(rays, renders, gains, growth, table),
              **{f"growth-{axis}": text for axis, text in growth_page.tables(growth, table, plain).items()}}
    pictures = {"ratios": ratio_plot(rays), "equal": gain_plot(gains),
                **{f"growth_{axis}": text for axis, text in growth_page.plots(growth).items()}}
    return blocks, pictures


def filled(text, blocks):
    """The page with its blocks, and the names of those that it has no place for."""
    missing = []
    for name, block in blocks.items():
        begin, end = f"<!-- {name} -->", f"<!-- end {name} -->"
        if begin not in text or end not in text:
            missing.append(name)
            continue
        before, rest = text.split(begin, 1)
        text = before + begin + "\n\n" + block + "\n\n" + end + rest.split(end, 1)[1]
    return text, missing


def write(docs, check=False):
    """Returns one line for each file that was not as it should be."""
    blocks, pictures = contents(docs)
    path = docs / "results.md"
    text, missing = filled(path.read_text(), blocks)
    if missing:
        sys.exit(f"{path}: no place for {', '.join(missing)}; it needs <!-- NAME --> and <!-- end NAME -->")
    files = {path: text, **{docs / f"pictures/results_{name}.svg": picture for name, picture in pictures.items()}}
    differing = []
    for file, new in files.items():
        if not file.exists() or file.read_text() != new:
            differing.append(f"{file}: differs from what the numbers say")
            if not check:
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_text(new)
    # No table was forgotten when a block was renamed.
    for name in re.findall(r"^<!-- (?!end )([\w-]+) -->$", text, re.MULTILINE):
        if name not in blocks:
            sys.exit(f"{path}: nobody writes {name}")
    return differing


if __name__ == "__main__":
    if len(sys.argv) < 2 or sys.argv[1] == "--help":
        sys.exit(__doc__)
    found = write(pathlib.Path(sys.argv[1]), "--check" in sys.argv[2:])
    if found and "--check" in sys.argv[2:]:
        sys.exit("\n".join(found) + "\nrun bench/page.py docs")
