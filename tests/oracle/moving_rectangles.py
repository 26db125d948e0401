#!/usr/bin/env python3
"""Pictures of moving rectangles that hide each other, integrated on closed form over each pixel and the shutter.

usage: moving_rectangles.py FOLDER SEED [--size WxH] [--rectangles N] [--window OPEN,CLOSE] [--curve T:W,T:W,...]

Writes FOLDER/scene.json with its meshes, and FOLDER/expected.pfm: flat colours through a box filter of a pixel's size. The
rectangles face the camera, each at a depth of its own, move on straight lines and change size; behind them one stands still.
--window: the shutter, in the time 0 to 1 of the motion. --curve: weights of time within the shutter, linear in between;
divided by their integral.

The area of a pixel that a rectangle covers and nothing in front of it does is, between the times at which an edge passes a
border of the pixel or another edge, a polynomial of second degree in time, and a weight makes it one of third: Simpson's rule
for each stretch in between is exact.
"""
import argparse
import json
import math
import pathlib
import random
import struct

VFOV_DEGREES = 50.0
HALF_HEIGHT = math.tan(math.radians(VFOV_DEGREES) / 2)  # of the view, at depth 1


def as_float(value):
    return struct.unpack("f", struct.pack("f", value))[0]


class Rectangle:
    """keys: [x0, x1, y0, y1] at times 0 and 1, in world units."""

    def __init__(self, depth, colour, keys):
        self.depth, self.colour = depth, [as_float(x) for x in colour]
        self.keys = [[as_float(x) for x in key] for key in keys]

    def edges_in_pixels(self, width, height):
        """[x0, x1, y0, y1] at times 0 and 1, y downwards."""
        unit = height / (2 * self.depth * HALF_HEIGHT)
        return [[width / 2 + x0 * unit, width / 2 + x1 * unit, height / 2 - y1 * unit, height / 2 - y0 * unit]
                for x0, x1, y0, y1 in self.keys]


def random_rectangles(count, aspect, rng):
    """Nearest first. The first one is thin and fast, so that it is nowhere for long."""
    rectangles = []
    for i in range(count + 1):
        depth = 3.0 + i
        half_x, half_y = depth * HALF_HEIGHT * aspect, depth * HALF_HEIGHT
        colour = [rng.uniform(0.1, 1) for _ in range(3)]
        if i == count:
            key = [-0.55 * half_x, 0.61 * half_x, -0.57 * half_y, 0.63 * half_y]
            rectangles.append(Rectangle(depth, colour, [key, key]))
            break
        x, y = rng.uniform(-0.7, 0.7) * half_x, rng.uniform(-0.7, 0.7) * half_y
        w, h = rng.uniform(0.05, 0.4) * half_x, rng.uniform(0.05, 0.4) * half_y
        move_x, move_y, growth = rng.uniform(-0.8, 0.8) * half_x, rng.uniform(-0.5, 0.5) * half_y, rng.uniform(0.7, 1.4)
        if i == 0:
            x, w, h, move_x, move_y = -0.6 * half_x, 0.004 * half_x, 0.5 * half_y, 1.1 * half_x, 0
        last_x, last_y, last_w, last_h = x + move_x, y + move_y, w * growth, h * growth
        rectangles.append(Rectangle(depth, colour, [[x - w, x + w, y - h, y + h],
                                                    [last_x - last_w, last_x + last_w, last_y - last_h, last_y + last_h]]))
    return rectangles


def intersection(a, b):
    return [max(a[0], b[0]), min(a[1], b[1]), max(a[2], b[2]), min(a[3], b[3])]


def area(box):
    return max(box[1] - box[0], 0) * max(box[3] - box[2], 0)


def area_of_union(boxes):
    """By inclusion and exclusion: of a few boxes."""
    if not boxes:
        return 0
    first, rest = boxes[0], boxes[1:]
    overlaps = [box for box in (intersection(first, other) for other in rest) if box[0] < box[1] and box[2] < box[3]]
    return area(first) + area_of_union(rest) - area_of_union(overlaps)


def crossing(p, q):
    """When two places on an axis, given at times 0 and 1, are the same; None: never, or always."""
    before, after = p[0] - q[0], p[1] - q[1]
    return before / (before - after) if before != after else None


class Picture:
    def __init__(self, rectangles, width, height, window, curve):
        self.width, self.height, self.window, self.curve = width, height, window, curve
        self.colours = [rectangle.colour for rectangle in rectangles]
        self.edges = [list(zip(*rectangle.edges_in_pixels(width, height))) for rectangle in rectangles]  # [rectangle][edge]
        self.integral = sum((t1 - t0) * (w0 + w1) / 2 for (t0, w0), (t1, w1) in zip(curve, curve[1:]))
        self.common_times = [window[0] + t * (window[1] - window[0]) for t, _ in curve]
        for i, first in enumerate(self.edges):
            for second in self.edges[:i]:
                self.common_times += [crossing(first[e], second[f]) for axis in ((0, 1), (2, 3)) for e in axis for f in axis]

    def weight(self, time):
        place = (time - self.window[0]) / (self.window[1] - self.window[0])
        for (t0, w0), (t1, w1) in zip(self.curve, self.curve[1:]):
            if t0 <= place <= t1 and t1 > t0:
                return (w0 + (w1 - w0) * (place - t0) / (t1 - t0)) / self.integral
        return 0

    def colour_at(self, x, y, time):
        colour, seen = [0.0] * 3, []
        for own, edges in zip(self.colours, self.edges):
            box = intersection([p + (q - p) * time for p, q in edges], [x, x + 1, y, y + 1])
            if box[0] >= box[1] or box[2] >= box[3]:
                continue
            share = area(box) - area_of_union([intersection(box, other) for other in seen if area(intersection(box, other)) > 0])
            colour = [c + share * o for c, o in zip(colour, own)]
            seen.append(box)
        return colour

    def pixel(self, x, y):
        borders = ((x, x + 1), (x, x + 1), (y, y + 1), (y, y + 1))
        times = self.common_times + [crossing(edge, (border, border)) for edges in self.edges
                                     for edge, pair in zip(edges, borders) for border in pair]
        opens, closes = self.window
        times = sorted({opens, closes, *(time for time in times if time is not None and opens < time < closes)})
        sums = [0.0] * 3
        for begin, end in zip(times, times[1:]):
            inset = (end - begin) * 1e-9  # at a border itself rounding could fall to the other side
            for time, simpson in ((begin + inset, 1 / 6), ((begin + end) / 2, 4 / 6), (end - inset, 1 / 6)):
                factor = simpson * (end - begin) / (closes - opens) * self.weight(time)
                sums = [s + factor * c for s, c in zip(sums, self.colour_at(x, y, time))]
        return sums


def write_scene(folder, rectangles, width, height, window):
    meshes, materials = [], {}
    for i, rectangle in enumerate(rectangles):
        names = [f"rectangle{i}_{key}.obj" for key in ("open", "close")]
        for name, (x0, x1, y0, y1) in zip(names, rectangle.keys):
            corners = ((x0, y0), (x1, y0), (x1, y1), (x0, y1))
            lines = [f"v {x!r} {y!r} {-rectangle.depth!r}" for x, y in corners] + ["f 1 2 3", "f 1 3 4"]
            (folder / name).write_text("\n".join(lines) + "\n")
        meshes.append({"name": f"rectangle{i}", "keys": names, "times": [0, 1], "material": f"material{i}"})
        materials[f"material{i}"] = {"base_color": rectangle.colour}
    camera = {"vfov_degrees": VFOV_DEGREES,
              "keys": [{"time": 0, "eye": [0, 0, 0], "target": [0, 0, -1], "up": [0, 1, 0]}]}
    (folder / "scene.json").write_text(json.dumps({
        "kairos": 1, "meshes": meshes, "materials": materials, "camera": camera, "shutter": window,
        "image": {"width": width, "height": height}}, indent=1))


def numbers(separator):
    return lambda text: [float(part) for part in text.split(separator)]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("seed", type=int)
    parser.add_argument("--size", default="48x32")
    parser.add_argument("--rectangles", type=int, default=4)
    parser.add_argument("--window", type=numbers(","), default=[0, 1])
    parser.add_argument("--curve", default="0:1,1:1")
    arguments = parser.parse_args()
    width, height = map(int, arguments.size.split("x"))
    curve = [numbers(":")(point) for point in arguments.curve.split(",")]
    rng = random.Random(f"rectangles {arguments.seed}")
    rectangles = random_rectangles(arguments.rectangles, width / height, rng)
    arguments.folder.mkdir(parents=True, exist_ok=True)
    write_scene(arguments.folder, rectangles, width, height, arguments.window)
    picture = Picture(rectangles, width, height, arguments.window, curve)
    with open(arguments.folder / "expected.pfm", "wb") as out:  # rows from the lowest up
        out.write(f"PF\n{width} {height}\n-1.0\n".encode())
        for y in reversed(range(height)):
            for x in range(width):
                out.write(struct.pack("<3f", *picture.pixel(x, y)))


if __name__ == "__main__":
    main()
