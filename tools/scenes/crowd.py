"""A square full of people who walk, run, wave and jump: each with a gait, a phase and key times of their own."""

import math
import random

from .native import Mesh, Scene, many
from .shapes import box, ground, turned

COUNT = 200
DEEP = 24.0  # metres of the square, away from the camera
COLOURS = [(0.55, 0.16, 0.12), (0.14, 0.28, 0.52), (0.62, 0.48, 0.16), (0.18, 0.40, 0.22), (0.46, 0.44, 0.42),
           (0.36, 0.18, 0.40), (0.10, 0.12, 0.16), (0.70, 0.66, 0.58)]


def times(a, b):
    """The product of two matrices of rows."""
    return tuple(tuple(sum(row[k] * b[k][j] for k in range(3)) for j in range(3)) for row in a)


def moved(matrix, point):
    return tuple(sum(m * p for m, p in zip(row, point)) for row in matrix)


def about(axis, angle):
    """A turn about the x, y or z axis."""
    c, s = math.cos(angle), math.sin(angle)
    return {"x": ((1, 0, 0), (0, c, -s), (0, s, c)), "y": ((c, 0, s), (0, 1, 0), (-s, 0, c)),
            "z": ((c, -s, 0), (s, c, 0), (0, 0, 1))}[axis]


def shape(make):
    """Vertices and triangles of what `make` adds to a mesh."""
    mesh = Mesh("part", "", smooth=True)
    make(mesh)
    row, corners = mesh.rows[0], mesh.triangles
    return ([tuple(row[i:i + 6]) for i in range(0, len(row), 6)],
            [tuple(corners[i:i + 3]) for i in range(0, len(corners), 3)])


def limb(length, radius, end_radius):
    """Hangs down from its joint, with round ends."""
    def make(mesh):
        profile = [(0.01, -length - 0.8 * end_radius, 0, -1), (0.8 * end_radius, -length - 0.5 * end_radius, 0.7, -0.7),
                   (end_radius, -length, 1, 0), (radius, 0.0, 1, 0), (0.8 * radius, 0.5 * radius, 0.7, 0.7),
                   (0.01, 0.8 * radius, 0, 1)]
        turned(mesh, (0, 0, 0), profile, sides=8)
    return shape(make)


def egg(mesh):
    profile = []
    for i in range(9):
        angle = math.pi * (i / 8 - 0.5)
        out, up = math.cos(angle), math.sin(angle)
        profile.append((max(0.004, 0.105 * out), 0.14 + 0.135 * up, out, up))
    turned(mesh, (0, 0, 0), profile, sides=12)


# In metres: from the joint that moves them, facing +z.
PARTS = {"pelvis": shape(lambda mesh: box(mesh, (-0.16, -0.10, -0.10), (0.16, 0.10, 0.10))),
         "chest": shape(lambda mesh: box(mesh, (-0.20, 0.08, -0.12), (0.20, 0.52, 0.12))), "head": shape(egg),
         "upper arm": limb(0.28, 0.055, 0.045), "forearm": limb(0.26, 0.045, 0.035), "thigh": limb(0.42, 0.085, 0.06),
         "shin": limb(0.40, 0.06, 0.045), "foot": shape(lambda mesh: box(mesh, (-0.045, -0.06, -0.08), (0.045, 0.02, 0.19)))}


def pose(clip, swing, phase):
    """(part, turn, joint) of each part, in the figure's own space. phase: in turns of its gait."""
    wave = math.sin(math.tau * phase)
    stride, bend = {"walk": (0.55, 0.5), "run": (0.95, 1.3), "wave": (0.06, 0.1), "jump": (0.25, 0.7)}[clip]
    hop = {"walk": 0.03, "run": 0.09, "wave": 0.01, "jump": 0.28}[clip] * abs(math.cos(math.tau * phase))
    hips = (0.0, 0.90 + hop, 0.0)
    lean = about("x", {"walk": 0.05, "run": 0.25, "wave": 0.0, "jump": 0.1}[clip])
    chest = times(lean, about("y", 0.25 * wave * stride))
    place = lambda origin, turn, offset: tuple(o + d for o, d in zip(origin, moved(turn, offset)))  # noqa: E731
    parts = [("pelvis", about("y", -0.2 * wave * stride), hips), ("chest", chest, hips),
             ("head", times(chest, about("x", 0.1 * wave)), place(hips, chest, (0, 0.54, 0)))]
    for side in (-1, 1):
        step = side * wave if clip != "jump" else wave
        thigh = about("x", -swing * stride * step)
        knee = times(thigh, about("x", swing * bend * (0.5 - 0.5 * math.cos(math.tau * phase + side))))
        hip = place(hips, about("y", 0), (0.10 * side, -0.08, 0))
        ankle = place(place(hip, thigh, (0, -0.42, 0)), knee, (0, -0.42, 0))
        parts += [("thigh", thigh, hip), ("shin", knee, place(hip, thigh, (0, -0.42, 0))), ("foot", knee, ankle)]
        if clip in ("wave", "jump"):
            upper = times(chest, about("z", side * (1.9 + 0.7 * swing * wave)))
            lower = times(upper, about("z", side * 0.5 * math.sin(math.tau * (phase + 0.2))))
        else:
            upper = times(chest, times(about("x", swing * stride * step), about("z", 0.12 * side)))
            lower = times(upper, about("x", -0.4 - 0.6 * bend * (0.5 + 0.5 * step)))
        shoulder = place(hips, chest, (0.25 * side, 0.47, 0))
        parts += [("upper arm", upper, shoulder), ("forearm", lower, place(shoulder, upper, (0, -0.29, 0)))]
    return parts


def figure(scene, number, rng, place, material):
    """A mesh with a key for each frame of its clip that the shutter needs."""
    clip = rng.choice(("walk", "walk", "run", "wave", "jump"))
    heading, size, swing = rng.uniform(0, math.tau), rng.uniform(0.88, 1.1), rng.uniform(0.8, 1.15)
    phase, cadence = rng.random(), {"walk": 0.12, "run": 0.2, "wave": 0.25, "jump": 0.2}[clip] * rng.uniform(0.7, 1.3)
    speed = {"walk": 0.12, "run": 0.35}.get(clip, 0.0) * rng.uniform(0.8, 1.2)  # metres per shutter
    frame, offset = 1 / rng.uniform(2.2, 5.5), rng.random()
    key_times = []
    while not key_times or key_times[-1] < 1:
        key_times.append((len(key_times) - offset) * frame)
    turn, mesh = about("y", heading), Mesh(f"figure{number}", material, len(key_times), smooth=True)
    poses = [pose(clip, swing, phase + cadence * time) for time in key_times]
    for parts in zip(*poses):
        keys = []
        for time, (name, own_turn, joint) in zip(key_times, parts):
            full, ahead = times(turn, own_turn), moved(turn, (0, 0, speed * time))
            joint = moved(turn, joint)
            keys.append([(*(p + a + size * (j + v) for p, a, j, v in zip(place, ahead, joint, moved(full, vertex[:3]))),
                          *moved(full, vertex[3:])) for vertex in PARTS[name][0]])
        mesh.add(keys, PARTS[parts[0][0]][1])
    scene.mesh(mesh, times=key_times)


def make(folder, options):
    rng = random.Random(200)
    scene = Scene(folder, 640, 360)
    scene.camera(30, ((0.0, 4.2, 9.0), (0.0, 0.4, -4.0)))
    scene.set(background=[0.45, 0.58, 0.78])
    scene.light("directional", direction=[-0.5, -0.8, -0.35], irradiance=[3.2, 3.0, 2.6])
    scene.light("constant", radiance=[0.32, 0.36, 0.44])
    square = Mesh("square", scene.material("square", (0.42, 0.40, 0.37)), smooth=True)
    ground(square, 60.0, 0.0)
    scene.mesh(square)
    cloths = [scene.material(f"cloth{i}", colour) for i, colour in enumerate(COLOURS)]
    count = many(COUNT, options.scale)
    # Nearer rows are narrower, as the view is; each figure has a cell of its own, so that nobody walks into another.
    rows = max(1, round(math.sqrt(count * 0.8)))
    for i in range(count):
        row, column = divmod(i, math.ceil(count / rows))
        depth = DEEP * (row + rng.uniform(0.25, 0.75)) / rows
        across = (column + rng.uniform(0.25, 0.75)) / math.ceil(count / rows) - 0.5
        place = (across * (7.0 + 1.0 * depth), 0.0, 3.0 - depth)
        figure(scene, i, rng, place, cloths[rng.randrange(len(cloths))])
    return scene
