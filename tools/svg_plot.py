"""Plots as SVG text, in the style of the pages under docs/. Python's standard library only."""

import math

WIDTH, HEIGHT, LEFT, BOTTOM, TOP, RIGHT = 520, 300, 44, 40, 24, 12
COLOURS = ["#d55e00", "#0072b2", "#009e73", "#cc79a7", "#999999", "#e69f00"]


def marks_of_decades(low, high, factors=(1, 2, 5)):
    """Powers of ten, and these times `factors`, between two positive numbers."""
    return [m for m in (f * 10.0**e for e in range(-9, 10) for f in factors) if low <= m <= high * (1 + 1e-9)]


def even_marks(low, high, most=8):
    """Multiples of 1, 2 or 5 times a power of ten, at most about `most`."""
    step = next(s for s in marks_of_decades(1e-6, 1e9) if (high - low) / s <= most)
    first = math.ceil(low / step - 1e-9)
    return [step * i for i in range(first, math.floor(high / step + 1e-9) + 1)]


def short(number):
    """10000 as 10k."""
    for size, letter in ((1e6, "M"), (1e3, "k")):
        if number >= size and number % (size / 1000) == 0 and number >= 10 * 1e3:
            return f"{number / size:g}{letter}"
    return f"{number:g}"


class Axis:
    """From numbers to places between `begin` and `end` on the picture."""

    def __init__(self, low, high, begin, end, logarithmic=False):
        self.low, self.high, self.begin, self.end, self.logarithmic = low, high, begin, end, logarithmic

    def __call__(self, value):
        if self.logarithmic:
            share = math.log(value / self.low) / math.log(self.high / self.low) if self.high > self.low else 0.5
        else:
            share = (value - self.low) / (self.high - self.low) if self.high > self.low else 0.5
        return self.begin + (self.end - self.begin) * share


def frame(title):
    return [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="11">',
            f'<rect width="{WIDTH}" height="{HEIGHT}" fill="#ffffff"/>',
            f'<text x="{LEFT}" y="15" font-size="12" fill="#222">{title}</text>']


def y_grid(y, marks):
    out = []
    for mark in marks:
        out.append(f'<line x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{y(mark):.1f}" y2="{y(mark):.1f}" stroke="#e4e4e4"/>')
        out.append(f'<text x="{LEFT - 6}" y="{y(mark) + 4:.1f}" text-anchor="end" fill="#555">{short(mark)}</text>')
    return out


def legend(entries):
    """(label, colour) each, along the lower edge."""
    out, step = [], (WIDTH - LEFT) / max(5, len(entries))
    for place, (label, colour) in enumerate(entries):
        out.append(f'<text x="{LEFT + place * step:.0f}" y="{HEIGHT - 8}" fill="{colour}">{label}</text>')
    return out


def lines(title, series, x_marks, y_marks, x_range, y_range, log_x=True, log_y=False):
    """series: list of (label, colour, dashed, [(x, y)]), drawn in this order."""
    x = Axis(*x_range, LEFT, WIDTH - RIGHT, log_x)
    y = Axis(*y_range, HEIGHT - BOTTOM, TOP, log_y)
    out = frame(title) + y_grid(y, y_marks)
    for mark in x_marks:
        out.append(f'<line x1="{x(mark):.1f}" x2="{x(mark):.1f}" y1="{TOP}" y2="{HEIGHT - BOTTOM}" stroke="#f0f0f0"/>')
        out.append(f'<text x="{x(mark):.1f}" y="{HEIGHT - BOTTOM + 14}" text-anchor="middle" fill="#555">{short(mark)}</text>')
    for _, colour, dashed, points in series:
        if not points:
            continue
        dash = ' stroke-dasharray="5 4"' if dashed else ""
        out.append(f'<polyline fill="none" stroke="{colour}" stroke-width="2"{dash} points="' +
                   " ".join(f"{x(a):.1f},{y(b):.1f}" for a, b in points) + '"/>')
        out += [f'<circle cx="{x(a):.1f}" cy="{y(b):.1f}" r="3" fill="{colour}"/>' for a, b in points]
    out += legend([(label, colour) for label, colour, _, points in series if points and label])
    return "\n".join(out + ["</svg>", ""])


def intervals(title, groups, series, y_marks, y_range):
    """Medians with their intervals, side by side. groups: names along x; series: list of (label, colour, values), values
    [group] of (median, low, high) or None."""
    y = Axis(*y_range, HEIGHT - BOTTOM, TOP)
    step = (WIDTH - LEFT - RIGHT) / max(1, len(groups))
    out = frame(title) + y_grid(y, y_marks)
    for place, group in enumerate(groups):
        middle = LEFT + (place + 0.5) * step
        out.append(f'<text x="{middle:.1f}" y="{HEIGHT - BOTTOM + 14}" text-anchor="middle" font-size="9" fill="#555">{group}</text>')
        for number, (_, colour, values) in enumerate(series):
            if values[place] is None:
                continue
            at = middle + step * 0.7 * ((number + 0.5) / len(series) - 0.5)
            median, low, high = (min(max(v, y_range[0]), y_range[1]) for v in values[place])
            out.append(f'<line x1="{at:.1f}" x2="{at:.1f}" y1="{y(low):.1f}" y2="{y(high):.1f}" stroke="{colour}" stroke-width="2"/>')
            out.append(f'<circle cx="{at:.1f}" cy="{y(median):.1f}" r="3.5" fill="{colour}"/>')
    out += legend([(label, colour) for label, colour, _ in series])
    return "\n".join(out + ["</svg>", ""])
