"""Things thinner than a pixel: wires that swing between still masts, and wheels of spokes that turn."""

import math

from demo_scene.maths import add, mul, sub

from .native import Mesh, Scene, many
from .shapes import box, frame, ground, tube

MASTS = [-4.6, -1.4, 1.8, 5.0]  # x; wires hang between neighbours
SIDES = 3


def thread(mesh, paths, radius):
    """A prism with three sides along a path per key; paths have equally many points."""
    keys = []
    for path in paths:
        vertices = []
        for i, point in enumerate(path):
            ahead = sub(path[min(i + 1, len(path) - 1)], path[max(i - 1, 0)])
            u, v = frame(ahead)
            for side in range(SIDES):
                angle = math.tau * side / SIDES
                out = add(mul(u, math.cos(angle)), mul(v, math.sin(angle)))
                vertices.append((*add(point, mul(out, radius)), *out))
        keys.append(vertices)
    triangles = []
    for i in range(len(paths[0]) - 1):
        for side in range(SIDES):
            a, b = i * SIDES + side, i * SIDES + (side + 1) % SIDES
            triangles += [(a, b, b + SIDES), (a, b + SIDES, a + SIDES)]
    mesh.add(keys, triangles)


def hanging(begin, end, sag, swing, points):
    """A wire that sags, its plane turned by `swing` radians."""
    path = []
    for i in range(points):
        x = i / (points - 1)
        depth = 4 * sag * x * (1 - x)
        path.append(add(add(begin, mul(sub(end, begin), x)), (0.0, -depth * math.cos(swing), depth * math.sin(swing))))
    return path


def wheel(rim, spokes_mesh, center, radius, spokes, degrees, times):
    """Turns about z, by `degrees` while the shutter is open."""

    def at(r, angle, z=0.0):
        return center[0] + r * math.cos(angle), center[1] + r * math.sin(angle), center[2] + z

    turns = [math.radians(degrees) * time for time in times]
    steps = 96
    thread(rim, [[at(radius, math.tau * i / steps + turn) for i in range(steps + 1)] for turn in turns], 0.012)
    for i in range(spokes):
        lean = 0.05 if i % 2 else -0.05
        begin, end = math.tau * i / spokes, math.tau * (i + (1.5 if i % 4 < 2 else -1.5)) / spokes
        paths = [[at(0.06, begin + turn, lean), at(radius, end + turn)] for turn in turns]
        thread(spokes_mesh, paths, 0.0035)


def make(folder, options):
    scene = Scene(folder, 640, 360)
    scene.camera(36, ((0.6, 1.35, 7.0), (0.2, 1.75, 0.0)))
    scene.set(background=[0.72, 0.62, 0.55])
    scene.light("directional", direction=[0.6, -0.6, -0.7], irradiance=[2.4, 2.0, 1.7])
    scene.light("constant", radiance=[0.40, 0.38, 0.40])
    wood, metal = scene.material("wood", (0.16, 0.11, 0.08)), scene.material("metal", (0.07, 0.07, 0.08))
    steel = scene.material("steel", (0.80, 0.78, 0.74))
    red = scene.material("red", (0.75, 0.12, 0.06))

    spans = max(options.spans, 4)  # a turn is round
    times = [key / spans for key in range(spans + 1)]
    wires = Mesh("wires", metal, len(times), smooth=True)
    rows = many(10, options.scale, 2)
    for left, right in zip(MASTS, MASTS[1:]):
        for row in range(rows):
            height, depth = 3.35 - 0.9 * row / rows, -0.35 + 0.7 * (row % 2)
            phase = 0.9 * row + 0.7 * left
            swings = [0.9 * math.sin(phase + 1.4 * time) for time in times]
            paths = [hanging((left, height, depth), (right, height, depth), 0.22 + 0.05 * (row % 3), swing, 40)
                     for swing in swings]
            thread(wires, paths, 0.004)
    rims, spokes = Mesh("rims", red, len(times), smooth=True), Mesh("spokes", steel, len(times), smooth=True)
    for center, radius, degrees in (((-2.5, 0.78, 0.9), 0.75, 34), ((-0.55, 0.78, 1.1), 0.75, -26),
                                    ((2.55, 1.0, 0.6), 0.95, 20)):
        wheel(rims, spokes, center, radius, many(72, options.scale, 6), degrees, times)

    masts = Mesh("masts", wood, smooth=True)
    for x in MASTS:
        tube(masts, (x, 0.0, 0.0), (x, 3.6, 0.0), 0.06, 0.045)
        box(masts, (x - 0.03, 3.25, -0.5), (x + 0.03, 3.37, 0.5))
        box(masts, (x - 0.03, 2.7, -0.5), (x + 0.03, 2.8, 0.5))
    for x, y, z in ((-2.5, 0.78, 0.9), (-0.55, 0.78, 1.1), (2.55, 1.0, 0.6)):
        tube(masts, (x, 0.0, z - 0.15), (x, y, z - 0.15), 0.03)
        tube(masts, (x, y, z - 0.2), (x, y, z + 0.08), 0.04)
    floor = Mesh("ground", scene.material("ground", (0.25, 0.20, 0.15)), smooth=True)
    ground(floor, 80.0, 0.0)
    for mesh in (wires, rims, spokes, masts, floor):
        scene.mesh(mesh)
    return scene
