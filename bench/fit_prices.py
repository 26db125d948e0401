#!/usr/bin/env python3
"""Fits the times by which `auto` estimates what rays cost, where nobody has measured it, to what they were measured to cost: the
constants of src/policy/ray_prices.cpp.

    bench/fit_prices.py BUILD OUT [--scenes FOLDER]    measures (bench_prices), and writes OUT/prices.csv
    bench/fit_prices.py --fit FILE.csv                 what its numbers give, and how far off that is

BUILD: a folder with the programs built, as build/release. Interrupted, the same command goes on. Needs nothing but Python's standard
library.

Measured are 1, 4 and 16 time-continuous rays in a pixel, discrete samples, and rays to what stands still, with normals and in the pixels in which
something moves, of every scene of the benchmark at three sizes; and samples where nothing does. Relative errors are what is made small.
How far the fit is to be trusted is said by three more: each leaves out a third of the scenes, with which it is checked.
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

SIZES = ("240x135", "480x270", "960x540")
# Scenes are checked by a fit to those of the other groups.
GROUPS = (("kitchen", "kitchen-slow", "kitchen-fast", "hair"), ("hall", "foliage", "garden", "veils"), ("blades", "wires", "crowd", "forest", "fan"))
RAYS = (1, 4, 16)
SHARE_RAYS = 4  # kShareRays of src/policy/ray_prices.h
# Names in the source, and what each is multiplied by. Of a time-continuous ray:
RAY = {"kRay": None, "kNode": "nodes", "kTriangle": "triangles", "kSolve": "solves", "kHit": "hits", "kSegment": "segments",
       "kEvaluation": "evaluations", "kLayer": "layers"}
TRACING = ("kNode", "kTriangle", "kSolve")  # the quicker, by kAgain, for rays that follow others of their pixel one by one
# Of a discrete sample, and of what it passes of what moves.
SAMPLE = ("kSample", "kSeen", "kStill", "kMoving", "kIdle")
PASSED = {"kInstantNode": "nodes", "kInstantTriangle": "triangles", "kInstantHit": "hits"}


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


def without(points, group):
    return {name: point for name, point in points.items() if name.split("/")[0] not in group}


def with_first(sample, times, samples):
    """In the mean over so many samples of a pixel."""
    return sample * (1 + times["kFirst"] / samples)


def resting_time(point, times, seen):
    """Of a sample to what stands still, but a pixel's first; seen: the share of such samples that see anything."""
    return times["kSample"] + seen * times["kSeen"] + point["anything_still", 0] * times["kStill"]


def sample_time(point, times):
    """Of a sample of everything, where something moves, but a pixel's first."""
    passed = sum(times[name] * point.get((what, 0), 0) for name, what in PASSED.items())
    share = point.get(("placed", 0), 0)
    return resting_time(point, times, point["seen", 0]) + times["kMoving"] * point["moving_trees", 0] + passed * (1 - share + share * times["kPlaced"])


def sample_errors(points, times):
    """Logarithms of estimate over measurement."""
    errors = []
    of = lambda sample, samples=64: with_first(sample, times, samples)  # noqa: E731
    for p in points.values():
        errors += [math.log(of(sample_time(p, times), samples) / p["discrete_ns", samples]) for samples in (4, 16, 64)]
        if ("resting_ns", 64) in p:
            resting = resting_time(p, times, p["resting_seen", 0])
            errors += [math.log(of(resting) / p["resting_ns", 64]), math.log(of(resting + times["kIdle"] * p["moving_trees", 0]) / p["resting_all_ns", 64])]
    return errors


def fresh(point, rays):
    """Of so many rays in a pixel, the share that comes upon what no other has come upon just before: all that go together in a packet,
    whose counts fall with their number, and else the first."""
    return 1 if point["nodes", rays] < 0.7 * point["nodes", 1] else 1 / rays


def estimated_ray_time(point, times, rays):
    again = fresh(point, rays)
    return sum(times[name] * (1 if what is None else point.get((what, rays), 0)) *
               (again + (1 - again) * times["kAgain"] if name in TRACING else 1) for name, what in RAY.items())


def ray_time(point, rays):
    """As measured, without the discrete rays that come with time-continuous ones."""
    beside = point["still_ns", 0] + SHARE_RAYS / rays * point["discrete_ns", 64] if point["anything_still", 0] else 0
    return max(point["tc_ns", rays] - beside, point["tc_ns", rays] / 4)


def ray_errors(points, times):
    return [math.log(estimated_ray_time(p, times, rays) / ray_time(p, rays)) for p in points.values() for rays in RAYS]


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


def fitted(points):
    """{name: nanoseconds}, to two digits."""
    times = {**fit(sample_errors, points, {**dict.fromkeys([*SAMPLE, *PASSED], 50.0), "kPlaced": 0.5, "kFirst": 1}),
             **fit(ray_errors, points, {**dict.fromkeys(RAY, 50.0), "kAgain": 0.5})}
    return {name: float(f"{value:.2g}") for name, value in times.items()}


def committed():
    text = (ROOT / "src/policy/ray_prices.cpp").read_text()
    return {name: float(re.search(rf"\b{name} = ([0-9.]+)", text)[1]) for name in [*SAMPLE, *PASSED, "kPlaced", "kFirst", *RAY, "kAgain"]}


def prices(point, times):
    """As estimate_prices() of src/policy/ray_prices.cpp: of 1, 4 and 16 rays."""
    sample, still = (with_first(time, times, 64) for time in (sample_time(point, times), resting_time(point, times, 1)))
    beside = lambda rays: still / sample + SHARE_RAYS / rays if point["anything_still", 0] else 0  # noqa: E731
    return [estimated_ray_time(point, times, rays) / sample + beside(rays) for rays in RAYS]


def measured(point):
    return [point["tc_ns", rays] / point["discrete_ns", 64] for rays in RAYS]


def report(rows):
    points = points_of(rows)
    found, was = fitted(points), committed()
    print("fitted:   ", found)
    print("committed:", "the same" if found == was else was)
    checked = {name: prices(point, times) for group in GROUPS for times in [fitted(without(points, group))]
               for name, point in points.items() if name.split("/")[0] in group}
    for label, estimates in (("fitted to all scenes", {name: prices(point, found) for name, point in points.items()}),
                             ("fitted to those of other groups", checked)):
        factors = [math.exp(abs(math.log(a / b))) for name, estimate in estimates.items() for a, b in zip(estimate, measured(points[name]))]
        print(f"{label}: prices off by a factor of {statistics.median(factors):.2f} in the median, {max(factors):.2f} at most")
    for name, point in points.items():
        print(f"{name}: sample {point['discrete_ns', 64]:.0f} ns ({with_first(sample_time(point, found), found, 64):.0f}), "
              + ", ".join(f"{rays} rays {is_so:.1f} ({estimate:.1f}; by others {check:.1f})"
                          for rays, is_so, estimate, check in zip(RAYS, measured(point), prices(point, found), checked[name])))


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
