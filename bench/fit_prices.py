#!/usr/bin/env python3
"""Fits the times by which `auto` estimates what rays cost, where nobody has measured it, to what they were measured to cost: the
constants of src/policy/ray_prices.cpp.

    bench/fit_prices.py BUILD OUT [--scenes FOLDER]    measures (bench_prices), and writes OUT/prices.csv
    bench/fit_prices.py --fit FILE.csv                 what its numbers give, and how far off that is

BUILD: a folder with the programs built, as build/release. Interrupted, the same command goes on. Needs nothing but Python's standard
library.

Measured are 1, 4 and 16 time-continuous rays in a pixel, discrete samples, and rays to what stands still, with normals and in the pixels in which
something moves, of every scene of the benchmark at two sizes. A third of the scenes is left
out of the fit: with them, it is checked. Relative errors are what is made small.
"""

import argparse
import math
import os
import pathlib
import re
import statistics
import sys

sys.dont_write_bytecode = True
ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "bench"))

import plan  # noqa: E402
from jobs import Jobs, collect, read_rows  # noqa: E402
from run import make_scene  # noqa: E402

SIZES = ("240x135", "960x540")
LEFT_OUT = ("kitchen", "wires", "garden", "hair", "crowd")  # of the fit: a third of the scenes
RAYS = (1, 4, 16)
SHARE_RAYS = 4  # kShareRays of src/policy/ray_prices.h
# Names in the source, and what each is multiplied by, of the two sums.
RAY = {"kRay": None, "kNode": "nodes", "kTriangle": "triangles", "kSolve": "solves", "kHit": "hits", "kSegment": "segments",
       "kEvaluation": "evaluations", "kLayer": "layers"}
SAMPLE = {"kSample": None, "kInstantNode": "nodes", "kInstantTriangle": "triangles", "kInstantHit": "hits"}


def measure(options):
    jobs, results = Jobs(options.build.resolve(), options.out.resolve()), []
    for shot in plan.SHOTS:
        if shot.large or shot.name in ("still", "garden-960") or shot.name.endswith("-whitted"):
            continue
        folder = options.out.resolve() / "scenes" / shot.maker()
        if not folder.exists() and not make_scene(folder.parent, shot.maker(), [], options):
            continue
        for size in SIZES:
            name = f"{shot.name}/{size}"
            results.append((name, jobs.run("prices", name, ["bench_prices", folder.parent / shot.scene, "--size", size, *shot.options], "")))
    collect(results, options.out / "prices.csv")
    return read_rows(options.out / "prices.csv")


def points_of(rows):
    """{name: {(measure, rays): value}}."""
    points = {}
    for row in rows:
        points.setdefault(row["point"], {})[row["measure"], int(row["rays"])] = float(row["value"])
    return points


def is_left_out(name):
    return name.split("/")[0] in LEFT_OUT


def split(points):
    """Those to fit by, and those to check with."""
    return ({name: point for name, point in points.items() if not is_left_out(name)},
            {name: point for name, point in points.items() if is_left_out(name)})


def total(times, names, point, rays):
    return sum(times[name] * (1 if what is None else point.get((what, rays), 0)) for name, what in names.items())


def sample_time(point, times, still):
    """still: nanoseconds of a ray to what stands still."""
    passed = total(times, SAMPLE, point, 0) - times["kSample"]
    share = point.get(("placed", 0), 0)
    return times["kSample"] + passed * (1 - share + share * times["kPlaced"]) + (still if point["anything_still", 0] else 0)


def sample_errors(points, times):
    """Logarithms of estimate over measurement."""
    return [math.log(sample_time(p, times, still_of(points)) / p["discrete_ns", 0]) for p in points.values()]


def still_of(points):
    return statistics.median(p["still_ns", 0] for p in points.values() if p["anything_still", 0])


def ray_time(point, rays):
    """As measured, without the discrete rays that come with time-continuous ones."""
    beside = point["still_ns", 0] + SHARE_RAYS / rays * point["discrete_ns", 0] if point["anything_still", 0] else 0
    return max(point["tc_ns", rays] - beside, point["tc_ns", rays] / 4)


def ray_errors(points, times):
    return [math.log(total(times, RAY, p, rays) / ray_time(p, rays)) for p in points.values() for rays in RAYS]


def fit(errors, points, times):
    """One constant after the other, by smaller and smaller factors, as long as that helps. What is far off counts no more than that."""
    size = lambda: sum(min(abs(error), 1.5) ** 2 for error in errors(points, times))  # noqa: E731
    times = dict(times)
    best, least = size(), 0.1
    for step in (2, 1.5, 1.2, 1.1, 1.05, 1.02):
        better = True
        while better:
            better = False
            for name in times:
                for factor in (step, 1 / step):
                    was = times[name]
                    times[name] = max(least, was * factor)
                    now = size()
                    if now < best * (1 - 1e-6):
                        best, better = now, True
                    else:
                        times[name] = was
    return times


def fitted(rows):
    """{name: nanoseconds}, to two digits."""
    points = split(points_of(rows))[0]
    times = {**fit(sample_errors, points, {**dict.fromkeys(SAMPLE, 50.0), "kPlaced": 0.5}), **fit(ray_errors, points, dict.fromkeys(RAY, 50.0))}
    times["kStill"] = still_of(points)
    return {name: float(f"{value:.2g}") for name, value in times.items()}


def committed():
    text = (ROOT / "src/policy/ray_prices.cpp").read_text()
    return {name: float(re.search(rf"\b{name} = ([0-9.]+)", text)[1]) for name in [*SAMPLE, "kPlaced", *RAY, "kStill"]}


def prices(point, times):
    """As estimate_prices() of src/policy/ray_prices.cpp: of 1, 4 and 16 rays."""
    sample = sample_time(point, times, times["kStill"])
    beside = lambda rays: times["kStill"] / sample + SHARE_RAYS / rays if point["anything_still", 0] else 0  # noqa: E731
    return [total(times, RAY, point, rays) / sample + beside(rays) for rays in RAYS]


def measured(point):
    return [point["tc_ns", rays] / point["discrete_ns", 0] for rays in RAYS]


def report(rows):
    found, was = fitted(rows), committed()
    print("fitted:   ", found)
    print("committed:", "the same" if found == was else was)
    for label, points in zip(("fitted by", "left out"), split(points_of(rows))):
        factors = [math.exp(abs(math.log(a / b))) for p in points.values() for a, b in zip(prices(p, found), measured(p))]
        print(f"{label}: prices off by a factor of {statistics.median(factors):.2f} in the median, {max(factors):.2f} at most")
    for name, point in points_of(rows).items():
        print(f"{name}{' (left out)' if is_left_out(name) else ''}: sample {point['discrete_ns', 0]:.0f} ns ({sample_time(point, found, found['kStill']):.0f}), "
              + ", ".join(f"{rays} rays {is_so:.1f} ({estimate:.1f})"
                          for rays, is_so, estimate in zip(RAYS, measured(point), prices(point, found))))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path, nargs="?", metavar="BUILD")
    parser.add_argument("out", type=pathlib.Path, nargs="?", metavar="OUT")
    parser.add_argument("--scenes", default=os.environ.get("KAIROS_SCENES", "../shared/scenes"), metavar="FOLDER",
                        help="third parties' scenes; $KAIROS_SCENES or %(default)s")
    parser.add_argument("--fit", type=pathlib.Path, metavar="FILE.csv")
    options = parser.parse_args()
    if not options.fit and not (options.build and options.out):
        parser.error("give BUILD and OUT, or --fit FILE.csv")
    report(read_rows(options.fit) if options.fit else measure(options))


if __name__ == "__main__":
    main()
