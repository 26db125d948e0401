"""The benchmark's command with scenes of a few triangles: it measures everything, goes on where it was interrupted, and writes
the page; and its arithmetic.

Usage: benchmark.py PROJECT_ROOT BUILD_DIR FOLDER
"""

import math
import pathlib
import re
import shutil
import subprocess
import sys

sys.dont_write_bytecode = True
root, build, out = pathlib.Path(sys.argv[1]), sys.argv[2], pathlib.Path(sys.argv[3])
sys.path += [str(root / "bench"), str(root / "tools")]

import aims  # noqa: E402
import estimates  # noqa: E402
import auto_table  # noqa: E402
import fit_prices  # noqa: E402
import instances  # noqa: E402
import jobs  # noqa: E402
import page  # noqa: E402
import run  # noqa: E402
import svg_plot  # noqa: E402
from numbers_of import Gains, Numbers, write_estimate  # noqa: E402

failures = []


def check(condition, message):
    if not condition:
        failures.append(message)


def near(a, b, margin=1e-3):
    return abs(a - b) <= margin


def check_table_of_auto():
    """Of methods that are better the longer they take, by known dB."""
    rows = []
    for method, shift in (("discrete", 0), ("spread", 1), ("tc", 2), ("mixed", -3), ("auto", 0.5)):
        for effort in (4, 16, 64):
            seconds = effort * (1.1 if method == "auto" else 1)
            psnr = 20 + 10 * math.log10(seconds) + shift
            rows += [{"point": "hall", "measure": f"{method}_{what}", "rays": effort, "round": 0, "value": value}
                     for what, value in (("s", seconds), ("db", psnr))]
    found = list(auto_table.judged(rows))
    check([row[1] for row in found] == [4, 16, 64] and all(
        row[5] == f"tc {row[1]}" and near(row[2] - row[3], -0.5 + 10 * math.log10(1.1)) and near(row[4] - row[2], 1.5 - 10 * math.log10(1.1)) and near(row[6], 1.1)
        for row in found), f"judged {found}")
    lines = auto_table.table(rows)
    check([line.split("  ")[-1] for line in lines[1:4]] == ["", "best", "best"] and
          lines[4].startswith("3 rows: 0 below") and " 2 below the best" in lines[4], "\n".join(lines))


def check_arithmetic():
    for degrees, quantile in ((1, 12.7062), (4, 2.7764), (11, 2.2010), (60, 2.0003)):  # tables of the distribution
        check(near(estimates.student_quantile(degrees), quantile), f"Student's quantile of {degrees} degrees")
    median, low, high = estimates.estimate([3, 1, 5, 2, 4])  # mean 3, standard deviation sqrt(2.5)
    check(median == 3 and near(high - 3, 2.7764 * math.sqrt(0.5)) and near(low + high, 6), "interval of five values")
    check(math.isnan(estimates.estimate([7])[1]), "one value says nothing about spread")
    median, low, high = estimates.estimate_of_ratios([1, 2, 4])
    check(median == 2 and near(low * high, 4), "an interval of ratios is even for a ratio and its inverse")
    check(write_estimate((1.234, 1.1, 1.36)) == "1.23 (1.10 to 1.36)" and write_estimate((2, math.nan, math.nan)) == "2.00" and
          write_estimate((0.5, -1, 2), 1, True) == "+0.5 (-1.0 to +2.0)" and write_estimate(None) == "-", "estimates as text")
    check(aims.verdict((5.5, 5, 6), 6, True) == "reached" and aims.verdict((6.1, 5, 7), 6, True) == "not reached" and
          aims.verdict((7, 6, 8), 5, False) == "reached" and aims.verdict(None, 5, False) == "not measured", "verdicts")
    check(aims.least([(1, 0, 2), None, (-1, -2, 0)])[0] == -1 and aims.least([None]) is None, "the least estimate")
    fitted = instances.fit(jobs.read_rows(root / "docs/results/instances.csv"))
    check(fitted == instances.committed(), f"bench/instances.py gives {fitted}, the source has {instances.committed()}")
    prices = fit_prices.fitted(fit_prices.points_of(jobs.read_rows(root / "docs/results/prices.csv")))
    check(prices == fit_prices.committed(), f"bench/fit_prices.py gives {prices}, the source has {fit_prices.committed()}")
    check_table_of_auto()
    folder = out / "arithmetic"
    folder.mkdir(parents=True)
    values = [("tc_ns", 4, 20), ("tc_ns", 4, 60), ("discrete_ns", 4, 10), ("discrete_ns", 4, 15), ("triangles", 0, 8)]
    jobs.write_rows(folder / "numbers.csv", [{"point": "a", "measure": m, "rays": n, "round": 0, "value": v}
                                             for m, n, v in values])
    numbers = Numbers(folder / "numbers.csv")
    check(numbers.ratio("a", "tc_ns", "discrete_ns", 4)[0] == 3, "ratios are taken within each round: 2 and 4")
    check(aims.between(numbers, "tc_ns", "a", "a", 4)[0] == 1 and aims.between(numbers, "tc_ns", "a", "b", 4) is None,
          "one measure of two points")
    check(numbers.median("a", "triangles") == 8 and numbers.median("b", "triangles") is None, "medians")
    text, missing = page.filled("x\n<!-- a -->\nold\n<!-- end a -->\ny", {"a": "new", "b": "none"})
    check(text == "x\n<!-- a -->\n\nnew\n\n<!-- end a -->\ny" and missing == ["b"], f"a filled page: {text}")
    check(svg_plot.marks_of_decades(10, 100) == [10, 20, 50, 100] and svg_plot.even_marks(0, 7) == list(range(8)), "marks")
    check([svg_plot.short(n) for n in (0.5, 500, 10000, 1e7)] == ["0.5", "500", "10k", "10M"], "short numbers")


def benchmark(*options):
    """The names of what was measured."""
    done = subprocess.run([sys.executable, root / "bench/run.py", build, out / "bench", "--tiny", "--scenes", out / "nothing",
                           *options], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode != 0:
        sys.exit(f"status {done.returncode} from bench/run.py\n{done.stdout}")
    return [line.rsplit(":", 1)[0] for line in done.stdout.splitlines() if line.endswith(" of the processor's)")]


def check_command():
    docs = out / "docs"
    (docs / "pictures").mkdir(parents=True)
    shutil.copy(root / "docs/results.md", docs)
    first = benchmark("--only", "rays,growth")
    check({"rays: blades", "growth: triangles/swarm/1000", "growth: spans/terrain/2"} <= set(first), f"measured {first}")
    # As an interruption leaves it: a result without its stamp, a study half done.
    (out / "bench/raw/rays/wires.json").unlink()
    second = benchmark("--page", docs)
    check([name for name in second if name.startswith(("rays", "growth"))] == ["rays: wires"], f"measured again {second}")
    check({"renders: blades", "equal: wires", "light: shade"} <= set(second), f"measured then {second}")
    (out / "bench/studies/wires/comparisons.csv").unlink()
    runs = (out / "bench/studies/wires/runs.csv").read_text()
    third = benchmark("--page", docs)
    check(third == ["equal: wires"], f"measured a third time {third}")
    check((out / "bench/studies/wires/runs.csv").read_text() == runs, "a study goes on from what it has")
    # The page's own commands are understood.
    commands = re.findall(r"^    (bench/run\.py .*)$", (root / "docs/results.md").read_text(), re.MULTILINE)
    check(len(commands) >= 5, f"the page shows {commands}")
    for command in commands:
        options = run.arguments(command.split()[1:], check_build=False)
        check(options.page == pathlib.Path("docs"), command)
    # Every number has found its place on the page.
    text = (docs / "results.md").read_text()
    for shown in ("| blades |", "| terrain | 1,012 |", "| wires: tc, 16 rays |", "| cost ratio, blades, 16 rays |", "| swarm | 32 |", "| crowd, 200 figures |", "| shade |"):
        check(shown in text, f"the page has no {shown}")
    gains = Gains(docs / "results")
    check(gains.gain("blades", "tc", "owen-sobol", "tc_rays", 4) is not None, "no gain at the time of four rays")
    for name in ("ratios", "equal", "growth_triangles", "growth_resolution", "growth_motion", "growth_spans", "growth_sets"):
        picture = docs / f"pictures/results_{name}.svg"
        check(picture.exists() and "<circle" in picture.read_text(), f"nothing is drawn in {picture}")
    check(page.write(docs, check=True) == [], "the page, written, is not what the numbers say")
    rays = docs / "results/rays.csv"
    rays.write_text(rays.read_text().replace("blades,tc_ns,4,0,", "blades,tc_ns,4,0,9", 1))
    check(page.write(docs, check=True) != [], "other numbers, the same page")


shutil.rmtree(out, ignore_errors=True)
check_arithmetic()
check_command()
# The committed page, where there are numbers for it.
if (root / "docs/results/rays.csv").exists():
    failures += page.write(root / "docs", check=True)
if failures:
    sys.exit("\n".join(failures))
