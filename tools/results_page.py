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

SERIES = [("multi-jitter", "#999999", "multi-jittered discrete"), ("owen-sobol", "#0072b2", "Owen-Sobol' discrete"),
          ("tc", "#d55e00", "time-continuous"), ("mixed", "#cc79a7", "mixed"), ("auto", "#009e73", "auto")]
WIDTH, HEIGHT, LEFT, BOTTOM, TOP, RIGHT = 520, 300, 44, 40, 24, 12


def rows(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def nice_times(low, high):
    """Powers of ten, and 2 and 5 times these, between two times."""
    marks = [m * 10.0**e for e in range(-4, 5) for m in (1, 2, 5)]
    return [m for m in marks if low <= m <= high]


def plot(name, curves):
    points = {s: [(float(c["seconds"]), float(c["psnr"])) for c in curves if c["series"] == s] for s, _, _ in SERIES}
    every = [p for series in points.values() for p in series]
    low, high = min(p[0] for p in every), max(p[0] for p in every)
    bottom, top = math.floor(min(p[1] for p in every) / 5) * 5, math.ceil(max(p[1] for p in every) / 5) * 5

    def x(seconds):
        return LEFT + (WIDTH - LEFT - RIGHT) * math.log(seconds / low) / math.log(high / low)

    def y(psnr):
        return HEIGHT - BOTTOM - (HEIGHT - TOP - BOTTOM) * (psnr - bottom) / (top - bottom)

    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="11">',
           f'<rect width="{WIDTH}" height="{HEIGHT}" fill="#ffffff"/>',
           f'<text x="{LEFT}" y="15" font-size="12" fill="#222">{name}: PSNR in dB over seconds of rendering, one thread</text>']
    for psnr in range(bottom, top + 1, 5):
        out.append(f'<line x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{y(psnr):.1f}" y2="{y(psnr):.1f}" stroke="#e4e4e4"/>')
        out.append(f'<text x="{LEFT - 6}" y="{y(psnr) + 4:.1f}" text-anchor="end" fill="#555">{psnr}</text>')
    for mark in nice_times(low, high):
        out.append(f'<line x1="{x(mark):.1f}" x2="{x(mark):.1f}" y1="{TOP}" y2="{HEIGHT - BOTTOM}" stroke="#f0f0f0"/>')
        out.append(f'<text x="{x(mark):.1f}" y="{HEIGHT - BOTTOM + 14}" text-anchor="middle" fill="#555">{mark:g}</text>')
    for place, (series, colour, label) in enumerate(SERIES):
        path = sorted(points[series])
        if not path:
            continue
        out.append(f'<polyline fill="none" stroke="{colour}" stroke-width="2" points="' +
                   " ".join(f"{x(s):.1f},{y(p):.1f}" for s, p in path) + '"/>')
        out += [f'<circle cx="{x(s):.1f}" cy="{y(p):.1f}" r="3" fill="{colour}"/>' for s, p in path]
        at = LEFT + place * 96
        out.append(f'<text x="{at}" y="{HEIGHT - 8}" fill="{colour}">{label.replace(" discrete", "")}</text>')
    return "\n".join(out + ["</svg>", ""])


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
