"""What the benchmark's files of numbers say, as estimates: medians with intervals."""

import math
import statistics

from estimates import estimate, estimate_of_ratios
from jobs import read_rows


class Numbers:
    """A file that jobs.collect() has written: each point's measures, with one value per round."""

    def __init__(self, path):
        self.values, self.points = {}, []
        for row in read_rows(path) if path.exists() else []:
            self.values.setdefault((row["point"], row["measure"], int(row["rays"])), []).append(float(row["value"]))
            if row["point"] not in self.points:
                self.points.append(row["point"])

    def rays(self, point, measure):
        """For which numbers of rays there are values."""
        return sorted(rays for p, m, rays in self.values if (p, m) == (point, measure))

    def median(self, point, measure, rays=0):
        values = self.values.get((point, measure, rays))
        return statistics.median(values) if values else None

    def ratio(self, point, above, below, rays=0, rays_below=None):
        """Of two measures, taken within each round."""
        a = self.values.get((point, above, rays))
        b = self.values.get((point, below, rays if rays_below is None else rays_below))
        if not a or not b or len(a) != len(b):
            return None
        return estimate_of_ratios([x / y for x, y in zip(a, b)])


def pooled(ratios):
    """One estimate of the medians of several."""
    found = [ratio[0] for ratio in ratios if ratio]
    return estimate_of_ratios(found) if found else None


class Gains:
    """The studies' comparisons: dB at equal time."""

    def __init__(self, folder):
        path = folder / "equal_comparisons.csv"
        self.rows = read_rows(path) if path.exists() else []
        curves = folder / "equal_curves.csv"
        self.curves = read_rows(curves) if curves.exists() else []
        self.points = list(dict.fromkeys(row["point"] for row in self.rows))

    def gain(self, point, series, baseline, at, value):
        for row in self.rows:
            if (row["point"], row["series"], row["baseline"], row["at"]) == (point, series, baseline, at) and \
                    float(row["value"]) == value and row["gain_db"]:
                return tuple(float(row[field] or "nan") for field in ("gain_db", "gain_low", "gain_high"))
        return None

    def near_reference(self, point, series, rays):
        """Is the reference not enough better than so many time-continuous rays?"""
        return any(row["point"] == point and row["series"] == series and int(row["tc_rays"] or 0) == rays and
                   row["near_reference"] == "1" for row in self.curves)


def write_estimate(value, digits=2, sign=False):
    """"5.57 (5.45 to 5.81)"; a dash for what is not known."""
    if value is None:
        return "-"
    plus = "+" if sign else ""
    median, low, high = (f"{number:{plus}.{digits}f}" for number in value)
    return median if math.isnan(value[1]) else f"{median} ({low} to {high})"
