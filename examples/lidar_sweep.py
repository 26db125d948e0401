"""What a spinning scanner measures while things move: its rays look one after the other, not all at once.

A ray of a Tracer is held fixed while the shutter is open. A scanner's column of rays looks for a moment: a query with a
window. Where a car drives by, the sweep is skewed, as real ones are; the picture shows it above what one instant shows.

Usage: lidar_sweep.py [OUT.png]
"""

import sys

import numpy as np

import kairos

COLUMNS, BEAMS = 720, 48
TURN = 0.1  # seconds for a revolution: the time that the shutter is open


def box(name, size, start, speed):
    """A box that moves at a speed, metres a second, during the turn."""
    corners = (np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]) - [0.5, 0, 0.5]) * size + start
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = [t for a, b, c, d in sides for t in ((a, b, c), (a, c, d))]
    return kairos.Mesh([corners, corners + np.multiply(speed, TURN)], triangles, key_times=[0, 1], name=name)


ground = kairos.Mesh([[-80, 0, 80], [80, 0, 80], [80, 0, -80], [-80, 0, -80]], [[0, 1, 2], [0, 2, 3]], name="ground")
tracer = kairos.Tracer([ground, box("car", (4.4, 1.5, 1.8), (1, 0, -6), (30, 0, 0)), box("truck", (9, 3.2, 2.5), (-6, 0, 9), (-25, 0, 0)),
                        box("post", (0.3, 4, 0.3), (5, 0, -4), (0, 0, 0)), box("house", (12, 6, 3), (-3, 0, -16), (0, 0, 0))])

azimuth = np.linspace(-np.pi, np.pi, COLUMNS, endpoint=False)  # of -z in the middle
elevation = np.radians(np.linspace(12, -24, BEAMS))
directions = np.stack([np.sin(azimuth)[:, None] * np.cos(elevation), np.broadcast_to(np.sin(elevation), (COLUMNS, BEAMS)),
                       -np.cos(azimuth)[:, None] * np.cos(elevation)], axis=-1)
rays = np.concatenate([np.broadcast_to([0, 1.8, 0], directions.shape), directions], axis=-1).astype(np.float32)


def ranges(hits):
    """What is seen first within a query's window, at the distance where it is then; infinite for nothing."""
    found = np.full(len(hits), np.inf, np.float32)
    some = np.flatnonzero(np.diff(hits.offsets))
    found[some] = hits.segments["dist_begin"][hits.offsets[some]]
    return found


sweep = np.stack([ranges(tracer.query(rays[c], window=(c / COLUMNS, (c + 1) / COLUMNS))) for c in range(COLUMNS)])
instant = ranges(tracer.query(rays.reshape(-1, 6), window=(0, 1 / COLUMNS))).reshape(COLUMNS, BEAMS)

differ = np.abs(np.minimum(sweep, 1000) - np.minimum(instant, 1000)) > 0.1
print(f"{sweep.size} ranges, {differ.mean():.1%} differ by more than 10 cm from those of the first instant")


def shade(image):
    """Near is bright: (BEAMS, COLUMNS), four pixels high."""
    return np.repeat(np.sqrt(1 / np.maximum(image.T / 3, 1)), 4, axis=0)


both = np.concatenate([shade(sweep), np.full((6, COLUMNS), 1, np.float32), shade(instant)]).astype(np.float32)
kairos.Image({"R": both, "G": both * 0.85, "B": both * 0.6}).write(sys.argv[1] if len(sys.argv) > 1 else "lidar_sweep.png")
