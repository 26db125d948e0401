#!/usr/bin/env python3
"""From the folders of several studies to what docs/results.md shows.

    tools/results_page.py STUDIES DOCS

For each folder of STUDIES (`kairos study ... -o STUDIES/NAME`): copies its curves and comparisons to DOCS/results/NAME_*.csv and draws
DOCS/pictures/results_NAME.svg, PSNR over rendering time. Prints tables for the page.
"""

import csv
import math
import pathlib
import shutil
import sys

sys.dont_write_bytecode = True
import svg_plot  # noqa: E402

SERIES = [("multi-jitter", "#999999", "multi-jittered discrete"), ("owen-sobol", "#0072b2", "Owen-Sobol' discrete"),
          ("tc", "#d55e00", "time-continuous"), ("mixed", "#cc79a7", "mixed"), ("auto", "#009e73", "auto")]


def rows(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def plot(name, curves):
    points = {s: sorted((float(c["seconds"]), float(c["psnr"])) for c in curves if c["series"] == s) for s, _, _ in SERIES}
    every = [p for series in points.values() for p in series]
    low, high = min(p[0] for p in every), max(p[0] for p in every)
    bottom, top = math.floor(min(p[1] for p in every) / 5) * 5, math.ceil(max(p[1] for p in every) / 5) * 5
    return svg_plot.lines(f"{name}: PSNR in dB over seconds of rendering, one thread",
                          [(label.replace(" discrete", ""), colour, False, points[s]) for s, colour, label in SERIES],
                          svg_plot.marks_of_decades(low, high), range(bottom, top + 1, 5), (low, high), (bottom, top))


def gain(comparisons, series, baseline, kind, value):
    for c in comparisons:
        if (c["series"], c["baseline"], c["at"]) == (series, baseline, kind) and float(c["value"]) == value and c["gain_db"]:
            return f'{float(c["gain_db"]):+.1f} ({float(c["gain_low"]):+.1f} to {float(c["gain_high"]):+.1f})'
    return "-"


def table(title, studies, columns):
    print(f"\n{title}\n")
    print("| scene | " + " | ".join(label for label, *_ in columns) + " |")
    print("| --- |" + " --- |" * len(columns))
    for name, comparisons in studies:
        print(f"| {name} | " + " | ".join(gain(comparisons, *key) for _, *key in columns) + " |")


def main():
    source, docs = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    (docs / "results").mkdir(parents=True, exist_ok=True)
    studies = []
    for folder in sorted(p for p in source.iterdir() if (p / "comparisons.csv").exists()):
        for kind in ("curves", "comparisons", "references"):
            shutil.copy(folder / f"{kind}.csv", docs / "results" / f"{folder.name}_{kind}.csv")
        (docs / "pictures" / f"results_{folder.name}.svg").write_text(
            plot(folder.name.replace("_", ", "), rows(folder / "curves.csv")))
        studies.append((folder.name.replace("_", ", "), rows(folder / "comparisons.csv")))
    decibels = [35.0, 38.0, 40.0, 45.0]
    budgets = [4.0, 8.0, 16.0, 32.0, 64.0, 128.0, 256.0]
    table("tc over multi-jittered discrete rays, at the time in which those reach", studies,
          [(f"{v:g} dB", "tc", "multi-jitter", "psnr", v) for v in decibels])
    table("tc over Owen-Sobol' discrete rays, at the time in which those reach", studies,
          [(f"{v:g} dB", "tc", "owen-sobol", "psnr", v) for v in decibels])
    table("auto over Owen-Sobol' discrete rays, at the time of so many samples of theirs", studies,
          [(f"{v:g}", "auto", "owen-sobol", "spp", v) for v in budgets])


if __name__ == "__main__":
    main()
