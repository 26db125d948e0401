"""A hall of stone that stands still, and a figure (GDQuest's mannequin, from the folder of third parties' scenes) that
runs through it. Everything but the figure rests relative to the camera: the paper's "Sponza + Hand".
"""

import math
import shutil

from demo_scene.maths import add, mul

from .native import Mesh, Scene, many
from .shapes import box, flat, grid, ground, turned

FPS = 24
NAVE, AISLE = 3.0, 5.6  # x of the columns' axes and of the outer walls
SPAN, SPANS, FRONT = 3.5, 5, 4.0  # between columns along z; how many; z of the first
SPRING, CORNICE, THICK = 4.1, 6.5, 0.28  # y where arches begin, y of the vault's foot; half of the walls' thickness
FIGURE = ("mannequiny/mannequiny.glb", "run_root.001")


def detail(options, count, least=3):
    """Subdivisions along one direction: their squares are what --scale asks for."""
    return many(count, math.sqrt(options.scale), least)


def column(mesh, x, z, options):
    """Base, shaft with flutes, capital."""
    box(mesh, (x - 0.42, 0.0, z - 0.42), (x + 0.42, 0.18, z + 0.42))
    box(mesh, (x - 0.40, SPRING - 0.14, z - 0.40), (x + 0.40, SPRING, z + 0.40))
    sides = detail(options, 48, 8)
    roll = [math.pi * (i / 8 - 0.5) for i in range(9)]
    torus = [(0.32 + 0.08 * math.cos(a), 0.26 + 0.08 * math.sin(a), math.cos(a), math.sin(a)) for a in roll]
    turned(mesh, (x, 0.0, z), torus, sides)
    bell = [(0.27 + 0.12 * s * s, SPRING - 0.45 + 0.31 * s, 0.8, -0.24 * 2 * s / 0.31 * 0.5) for s in
            [i / 8 for i in range(9)]]
    turned(mesh, (x, 0.0, z), [(r, h, o / math.hypot(o, u), u / math.hypot(o, u)) for r, h, o, u in bell], sides)
    flutes, low, high = 20, 0.34, SPRING - 0.45

    def shaft(around, along):
        angle = math.tau * around
        radius = 0.31 - 0.04 * along ** 1.5 - 0.012 * (0.5 + 0.5 * math.cos(flutes * angle))
        slope = 0.012 * 0.5 * flutes * math.sin(flutes * angle) / radius  # d radius / d angle, by the radius
        out, tangent = (math.sin(angle), 0.0, math.cos(angle)), (math.cos(angle), 0.0, -math.sin(angle))
        normal = mul(add(out, mul(tangent, -slope)), 1 / math.hypot(1, slope))
        return (x + radius * out[0], low + (high - low) * along, z + radius * out[2], *normal)

    grid(mesh, detail(options, 12, 1), flutes * detail(options, 6, 2), shaft)


def arcade(mesh, trim, x, options):
    """The wall above a row of columns, with its arches."""
    steps = detail(options, 32, 4)
    radius = SPAN / 2 - 0.30
    for i in range(SPANS):
        middle = FRONT - SPAN * (i + 0.5)
        for side in (-1, 1):
            face = x + side * THICK

            def wall(u, v, face=face, side=side, middle=middle):
                u = u if side < 0 else 1 - u
                angle = math.pi * (1 - u)
                z0, y0 = middle + radius * math.cos(angle), SPRING + radius * math.sin(angle)
                z1 = middle + SPAN / 2 * (2 * u - 1)
                return (face, y0 + (CORNICE - y0) * v, z0 + (z1 - z0) * v, float(side), 0.0, 0.0)

            grid(mesh, 2, steps, wall)
            for end in (-1, 1):
                corner = (face, SPRING, middle + end * radius), (face, SPRING, middle + end * SPAN / 2), \
                    (face, CORNICE, middle + end * SPAN / 2)
                flat(mesh, corner if end * side < 0 else corner[::-1])

        def soffit(u, v, middle=middle):
            angle = math.pi * u
            return (x - THICK + 2 * THICK * v, SPRING + radius * math.sin(angle), middle + radius * math.cos(angle),
                    0.0, -math.sin(angle), -math.cos(angle))

        grid(mesh, 1, steps, soffit)
        inward = -1 if x > 0 else 1

        def moulding(u, v, middle=middle):
            angle, roll = math.pi * u, math.tau * v
            reach = radius + 0.10 + 0.07 * math.cos(roll)
            out = math.cos(roll)
            return (x + inward * (THICK + 0.07 * math.sin(roll)), SPRING + reach * math.sin(angle),
                    middle + reach * math.cos(angle), inward * math.sin(roll), out * math.sin(angle),
                    out * math.cos(angle))

        grid(trim, detail(options, 10, 4), steps, moulding)


def vault(mesh, trim, options):
    """A barrel vault with sunken coffers, and a cornice under it."""
    reach, back = NAVE - THICK + 0.02, FRONT - SPAN * SPANS
    around, along = detail(options, 9, 3), detail(options, 22, 4)

    def at(u, v, depth):
        angle = math.pi * u
        return ((reach + depth) * math.cos(angle), CORNICE + (reach + depth) * math.sin(angle),
                FRONT + (back - FRONT) * v)

    for i in range(around):
        for j in range(along):
            u0, u1, v0, v1 = i / around, (i + 1) / around, j / along, (j + 1) / along
            du, dv = 0.17 * (u1 - u0), 0.17 * (v1 - v0)
            outer = [at(u0, v0, 0), at(u1, v0, 0), at(u1, v1, 0), at(u0, v1, 0)]
            inner = [(u0 + du, v0 + dv), (u1 - du, v0 + dv), (u1 - du, v1 - dv), (u0 + du, v1 - dv)]
            rim, bottom = [at(*p, 0) for p in inner], [at(*p, 0.22) for p in inner]
            for k in range(4):
                n = (k + 1) % 4
                flat(mesh, [outer[k], rim[k], rim[n], outer[n]][::-1])
                flat(mesh, [rim[k], bottom[k], bottom[n], rim[n]][::-1])
            flat(trim, bottom)
    for side in (-1, 1):
        x = side * (NAVE - THICK)
        box(trim, (min(x, x - side * 0.16), CORNICE - 0.10, back), (max(x, x - side * 0.16), CORNICE + 0.08, FRONT))


def balustrade(mesh, x, options):
    profile_points = [(0.0, 0.055), (0.06, 0.055), (0.1, 0.03), (0.2, 0.055), (0.34, 0.075), (0.48, 0.045), (0.58, 0.028),
                      (0.66, 0.05), (0.72, 0.055)]
    profile = []
    for i, (height, radius) in enumerate(profile_points):
        below, above = profile_points[max(i - 1, 0)], profile_points[min(i + 1, len(profile_points) - 1)]
        out, up = above[0] - below[0], below[1] - above[1]
        profile.append((radius, 0.12 + height, out / math.hypot(out, up), up / math.hypot(out, up)))
    for i in range(SPANS):
        high, low = FRONT - SPAN * i - 0.42, FRONT - SPAN * (i + 1) + 0.42
        box(mesh, (x - 0.12, 0.0, low), (x + 0.12, 0.12, high))
        box(mesh, (x - 0.13, 0.84, low), (x + 0.13, 0.96, high))
        count = 11
        for k in range(count):
            turned(mesh, (x, 0.0, low + (high - low) * (k + 0.5) / count), profile, detail(options, 20, 6))


def build(folder, options):
    scene = Scene(folder, 640, 360)
    scene.camera(44, ((-1.35, 1.45, 6.9), (-0.1, 2.0, -3.0)))
    scene.set(background=[0.55, 0.70, 0.95])
    scene.light("directional", direction=[-0.72, -0.62, -0.22], irradiance=[4.2, 3.6, 2.7])
    scene.light("constant", radiance=[0.42, 0.50, 0.62])
    stone = Mesh("stone", scene.material("stone", (0.70, 0.62, 0.50)), smooth=True)
    trim = Mesh("trim", scene.material("trim", (0.56, 0.36, 0.26)), smooth=True)
    rail = Mesh("rail", scene.material("rail", (0.78, 0.74, 0.66)), smooth=True)
    dark = Mesh("dark tiles", scene.material("dark tiles", (0.16, 0.13, 0.12), roughness=0.12), smooth=True)
    light = Mesh("light tiles", scene.material("light tiles", (0.66, 0.58, 0.48), roughness=0.12), smooth=True)
    lamp = Mesh("lamp", scene.material("lamp", (0, 0, 0), emission=[3.6, 3.2, 2.6]), smooth=True)
    for x in (-NAVE, NAVE):
        for i in range(SPANS + 1):
            column(stone, x, FRONT - SPAN * i, options)
        arcade(stone, trim, x, options)
        balustrade(rail, x, options)
    vault(stone, trim, options)
    back, side, top = FRONT - SPAN * SPANS, 0.5, CORNICE
    box(stone, (-AISLE - 0.3, -0.5, back - 0.5), (-AISLE, top, FRONT + 6))
    box(stone, (-AISLE, top, back), (-NAVE - THICK, top + 0.2, FRONT + 6))
    box(stone, (-AISLE - 0.3, -0.5, back - 0.8), (AISLE, CORNICE + NAVE + 0.5, back - 0.3))
    flat(lamp, [(-1.5, 2.2, back - 0.25), (1.5, 2.2, back - 0.25), (1.5, 5.6, back - 0.25), (-1.5, 5.6, back - 0.25)])
    for i in range(3):
        box(trim, (-1.58 + 1.04 * i, 2.1, back - 0.26), (-1.5 + 1.04 * i, 5.7, back - 0.1))
    flat(lamp, [(-1.2, 6.2, 7.6), (1.2, 6.2, 7.6), (1.2, 6.2, 9.6), (-1.2, 6.2, 9.6)])
    columns, rows = 23, 56
    for i in range(columns):
        for j in range(rows):
            x, z = -AISLE + side * i, FRONT + 6 - side * j
            flat(light if (i + j) % 2 else dark, [(x, 0, z), (x + side, 0, z), (x + side, 0, z - side), (x, 0, z - side)])
    meadow = Mesh("meadow", scene.material("meadow", (0.30, 0.36, 0.16)), smooth=True)
    ground(meadow, 90.0, -0.04)
    for mesh in (stone, trim, rail, dark, light, lamp, meadow):
        scene.mesh(mesh)
    return scene


def make(folder, options):
    """The figure runs to the right at four metres per second; --frame 0 to 13 show a step of it each."""
    file, animation = FIGURE
    scene = build(folder, options)
    shutil.copyfile(options.scenes / file, folder / "figure.glb")
    (folder / "figure.glb").chmod(0o644)
    duration, speed, start = 0.6, 4.0, -1.75
    keys = [{"time": time, "matrix": [0, 0, -1, 0, 0, 1, 0, 0, 1, 0, 0, 0, start + speed * time, 0.05, 2.7, 1]}
            for time in (0, duration)]
    scene.set(include=[{"file": "figure.glb", "animation": animation, "transform": keys}],
              shutter=[8 / FPS, 8.5 / FPS])
    return scene
