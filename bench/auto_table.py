#!/usr/bin/env python3
"""Is `auto` ever worse than discrete samples that go where they are needed, and how near does it come to the best fixed choice?

    bench/run.py BUILD OUT --only auto               measures
    bench/auto_table.py OUT/results/auto.csv         says so: a line for each scene and budget

Every scene of the benchmark is rendered by `auto` with budgets of 2 to 512 samples; by discrete samples, spread as `auto` spreads them
("spread": auto, told that time-continuous rays are far too dear) and not; by 1, 2, 4, ... time-continuous rays; and by
`mixed`. Times are the processor's, of one thread (bench_auto). Two things are asked of `auto`: with no budget more than 0.2 dB below
spread samples with the same; and with 16 samples or more at most 1 dB below
the best of all fixed choices that take no longer than as many discrete samples or than `auto` did. Its time is given over that of as many discrete samples.
Medians over seeds. Needs nothing but Python's standard library.
"""

import math
import pathlib
import statistics
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

from jobs import read_rows  # noqa: E402
from plan import TITLES  # noqa: E402

MOST_BELOW_SPREAD, MOST_BELOW_BEST, FROM_BUDGET = 0.2, 1.0, 16  # decibels; samples


def curve(rows, method):
    """[(logarithm of seconds, PSNR, effort)], medians over seeds, by time."""
    points = {}
    for row in rows:
        points.setdefault(int(row["rays"]), {}).setdefault(row["measure"], []).append(float(row["value"]))
    return sorted((math.log(statistics.median(seen[f"{method}_s"])), statistics.median(seen[f"{method}_db"]), effort)
                  for effort, seen in points.items() if f"{method}_s" in seen)


def judged(rows):
    """(scene, budget, PSNR of auto, of spread samples, of the best fixed choice, which that is, time of auto over
    that of as many discrete samples, of spread samples)."""
    for name in dict.fromkeys(row["point"] for row in rows):
        own = [row for row in rows if row["point"] == name]
        curves = {method: curve(own, method) for method in ("auto", "spread", "discrete", "tc", "mixed")}
        known = {(method, effort): (time, psnr) for method, points in curves.items() for time, psnr, effort in points}
        for time, psnr, budget in sorted(curves["discrete"], key=lambda point: point[2]):
            if ("auto", budget) not in known:
                continue
            auto_time, auto = known["auto", budget]
            spread_time, spread = known["spread", budget]
            affordable = [(psnr, f"{budget} discrete")] + [
                (p, f"{method} {effort}") for method in ("tc", "mixed") for t, p, effort in curves[method] if t <= max(time, auto_time)]
            yield (name, budget, auto, spread, *max(affordable), math.exp(auto_time - time), math.exp(spread_time - time))


def table(rows):
    """Lines of text."""
    lines, below_spread, below_best, times = [], 0, 0, []
    lines.append(f"{'scene':<16} {'budget':>6} {'auto':>6} {'spread':>6} {'best':>6} {'of which':<14} auto-spread auto-best  time spread's")
    for name, budget, auto, spread, best, which, time, spread_time in judged(rows):
        to_spread, to_best = auto - spread, auto - best
        marks = ("spread " if to_spread < -MOST_BELOW_SPREAD else "") + \
            ("best" if to_best < -MOST_BELOW_BEST and budget >= FROM_BUDGET else "")
        below_spread += "spread" in marks
        below_best += "best" in marks
        times.append(time)
        lines.append(f"{name:<16} {budget:>6} {auto:>6.1f} {spread:>6.1f} {best:>6.1f} {which:<14} {to_spread:>+11.1f} {to_best:>+9.1f} "
                     f"{time:>5.2f} {spread_time:>8.2f}  {marks}")
    within = sum(1 / 1.15 <= time <= 1.15 for time in times)
    lines.append(f"{len(times)} rows: {below_spread} below spread samples by more than {MOST_BELOW_SPREAD} dB, {below_best} below the best by more than "
                 f"{MOST_BELOW_BEST:g} dB; time within 15 % in {within}, median {statistics.median(times):.2f}")
    return lines


def summary(rows, write_table):
    """A line for each scene, and one for all: for a page."""
    if not rows:
        return "Nothing has been measured."
    found, lines = list(judged(rows)), []
    for name in [*dict.fromkeys(row[0] for row in found), "all"]:
        own = [row for row in found if name in ("all", row[0])]
        dear = [row for row in own if row[1] >= FROM_BUDGET]
        to_spread, to_best = [row[2] - row[3] for row in own], [row[2] - row[4] for row in dear]
        lines.append([TITLES.get(name, name), f"{max(to_spread):+.1f}", f"{min(to_spread):+.1f}",
                      f"{sum(d < -MOST_BELOW_SPREAD for d in to_spread)} of {len(own)}", f"{min(to_best):+.1f}" if to_best else "-",
                      f"{sum(d < -MOST_BELOW_BEST for d in to_best)} of {len(dear)}",
                      f"{min(row[6] for row in own):.2f} to {max(row[6] for row in own):.2f}"])
    return write_table(["scene", "over spread samples: most, dB", "least", "below by 0.2", f"over the best fixed choice from {FROM_BUDGET} samples on: least, dB",
                        "below by 1", "time"], lines)


if __name__ == "__main__":
    if len(sys.argv) != 2 or sys.argv[1] == "--help":
        sys.exit(__doc__)
    print("\n".join(table(read_rows(sys.argv[1]))))
